// What a scene's folder tells an evaluation: true poses, cameras, and how much of the part is to be seen.
#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "apps/data_set/bop_scene.hpp"
#include "apps/error_measures/frame_errors.hpp"

namespace nearpose::evaluation {

struct SceneTruth {
    data_set::BopScene scene;
    int object_id = 1;
    std::optional<int> mask_index;        // which of several instances; none: the first
    std::vector<TrueFrame> frames;        // those between first and last that have the object
    std::vector<data_set::Frame> images;  // parallel: camera and stamp of each
    std::set<int> frames_left_out;        // those before the first and after the last
    // Why frames have no visibility; empty: all have it.
    std::string visibility_problem;
};

// Throws std::runtime_error naming the file where the scene has no truth or not for this object, or none of the frames
// asked for has the object. `mask_index` as in bop_ground_truth.hpp.
SceneTruth read_truth(const std::filesystem::path& scene_folder, int object_id,
                      const data_set::SceneOptions& options = {}, std::optional<int> mask_index = std::nullopt);

// Reads the depth and the masks of the visible part, and the visible fractions where there are some. A frame whose
// files are missing or broken stays without; the first cause is kept in visibility_problem.
void add_visibility(SceneTruth& truth);

}  // namespace nearpose::evaluation
