// Runs a whole scene through the estimator, as the program does, and scores it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/error_measures/frame_errors.hpp"

namespace nearpose::test {

struct SceneRun {
    std::string method = "default";
    std::string views = "raycast";
    bool with_masks = true;
    int particles = 200;
    std::uint64_t seed = 1;
};

// One entry a frame with ground truth. Throws where anything cannot be read.
std::vector<evaluation::FrameErrors> run_scene(const std::filesystem::path& scene, const std::filesystem::path& models,
                                               const SceneRun& run);

// From frame `first` on: the largest errors, infinite where a frame has no pose.
evaluation::PoseErrors worst_after(const std::vector<evaluation::FrameErrors>& frames, std::size_t first);

}  // namespace nearpose::test
