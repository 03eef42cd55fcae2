// What a run of the estimator was told: the input, the model, the method, where the outputs go.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "apps/part_model/model_input.hpp"
#include "apps/runs/frame_source.hpp"
#include "core/estimator.hpp"

namespace nearpose::program {

struct OutputOptions {
    std::filesystem::path run;         // folder that gets all of it; empty: none
    std::filesystem::path out;         // BOP result file
    std::filesystem::path log;         // empty: none; the same for the next two
    std::filesystem::path trajectory;  // TUM rows
    std::filesystem::path pictures;    // folder
    std::string trajectory_frame = "camera";
};

struct EstimateOptions {
    std::filesystem::path scene, clouds, camera;
    ModelOptions model;
    OutputOptions outputs;
    std::string views = "raycast", method = "default", symmetries = "auto";
    std::optional<int> particles;  // not given: up to the usual number, fewer in tracking
    int threads = EstimatorOptions{}.num_threads;
    std::uint64_t seed = EstimatorOptions{}.seed;
    bool no_mask = false, mask_first_frame = false, no_control = false;
    std::filesystem::path set_up;  // errors of the set-up, to be corrected; empty: it is as given
    bool self_calibrate = false;   // or by the recording itself
    std::optional<int> mask_index, first, last, scene_id;
    double fps = 30.0;
    std::filesystem::path initial_pose;
    double initial_sigma_mm = 10.0, initial_sigma_deg = 5.0;
    double tolerance_mm = 2.0, tolerance_deg = 1.0;
    double budget_ms = 0.0;  // 0: none
};

// The frames that they name.
std::unique_ptr<FrameSource> open_source(const EstimateOptions& options);

// Those of the recording and of the part, of seed and threads.
void add_input_options(CLI::App& command, EstimateOptions& options);
// Throws BadUse where they do not fit together.
void check_input(const EstimateOptions& options);

}  // namespace nearpose::program
