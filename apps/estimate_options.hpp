// What `nearpose estimate` can be told.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "apps/estimate_outputs.hpp"
#include "apps/frame_source.hpp"
#include "apps/model_input.hpp"
#include "core/estimator.hpp"

namespace nearpose::program {

struct EstimateOptions {
    std::filesystem::path scene, clouds, camera;
    ModelOptions model;
    OutputOptions outputs;
    std::string views = "raycast", method = "default", symmetries = "auto";
    std::optional<int> particles;  // not given: up to the usual number, fewer while one mode holds
    int threads = EstimatorOptions{}.num_threads;
    std::uint64_t seed = EstimatorOptions{}.seed;
    bool no_mask = false, no_control = false;
    std::optional<int> mask_index, first, last, scene_id;
    double fps = 30.0;
    std::filesystem::path initial_pose;
    double initial_sigma_mm = 10.0, initial_sigma_deg = 5.0;
    double tolerance_mm = 2.0, tolerance_deg = 1.0;
    double budget_ms = 0.0;  // 0: none
};

void add_estimate_options(CLI::App& command, EstimateOptions& options);

// Throws BadUse where they do not fit together.
void check(const EstimateOptions& options);

// The frames that they name.
std::unique_ptr<FrameSource> open_source(const EstimateOptions& options);

}  // namespace nearpose::program
