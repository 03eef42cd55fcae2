// True poses of a BOP scene. For evaluation only: nothing that estimates may include this header.
#pragma once

#include <filesystem>
#include <map>
#include <optional>

#include "core/base/pose.hpp"

namespace nearpose::data_set {

// camera_from_object by frame number, from scene_gt.json; frames without the object are left out, and of several
// instances in a frame the one at `index` of the frame's list counts (KKKKKK of its mask files), or else the first.
// Throws std::runtime_error naming file, frame and key; also where no frame has the object.
std::map<int, Pose> read_ground_truth(const std::filesystem::path& scene_folder, int object_id,
                                      std::optional<int> index = std::nullopt);

// The visible part of the object's silhouette by frame number, in 0..1 (visib_fract of scene_gt_info.json, of the same
// instance as above); empty where there is no such file. Throws std::runtime_error naming file, frame and key.
std::map<int, double> read_visible_fractions(const std::filesystem::path& scene_folder, int object_id,
                                             std::optional<int> index = std::nullopt);

}  // namespace nearpose::data_set
