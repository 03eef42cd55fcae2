// Poses as BOP writes them: a row-major rotation and a translation in millimetres.
#pragma once

#include <optional>
#include <string>

#include "apps/base/notices.hpp"
#include "apps/data_set/json_file.hpp"
#include "core/base/pose.hpp"

namespace nearpose::data_set {

// From 9 and 3 numbers, flat or by rows, as cam_R_m2c and cam_t_m2c. A rotation whose elements are off the nearest one
// by up to 1e-3 (files with few digits) is replaced by it; others are refused.
Pose read_bop_pose(const JsonValue& frame, const std::string& rotation_key, const std::string& translation_key);

// The measured camera motion cam_R_w2c, cam_t_w2c. A rotation may be off by up to 1e-2, which is noted. nullopt without
// it, and where it cannot be used: half there, null, NaN, no rotation; that is noted too.
std::optional<Pose> read_motion(const JsonValue& frame, int frame_id, Notices& notices);

}  // namespace nearpose::data_set
