// Runs a whole scene through the estimator, as the program does, and scores it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/pose_error.hpp"

namespace nearpose::test {

struct SceneRun {
    std::string method = "default";
    std::string views = "raycast";
    bool with_masks = true;
    int particles = 200;
    std::uint64_t seed = 1;
};

// One entry a frame with ground truth. Throws where anything cannot be read.
std::vector<program::FrameError> run_scene(const std::filesystem::path& scene, const std::filesystem::path& models,
                                           const SceneRun& run);

// From frame `first` on: the largest errors, infinite where a frame has no pose.
program::PoseError worst_after(const std::vector<program::FrameError>& frames, std::size_t first);

}  // namespace nearpose::test
