// A pose as a JSON file, with BOP's keys.
#pragma once

#include <filesystem>

#include "core/base/pose.hpp"

namespace nearpose::program {

// camera_from_object from {"cam_R_m2c": [9 numbers, row-major], "cam_t_m2c": [3 numbers, mm]} or the same as "R" and
// "t". Throws std::runtime_error naming file and key where a number is missing, not finite, or the rotation is none.
Pose read_pose_file(const std::filesystem::path& path);

}  // namespace nearpose::program
