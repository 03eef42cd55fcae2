// Several filters over the same frames.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/data_set/bop_models.hpp"
#include "apps/error_measures/frame_errors.hpp"
#include "apps/runs/estimator_setup.hpp"
#include "apps/scenes/parts.hpp"
#include "apps/scenes/recording.hpp"
#include "core/observation/observation.hpp"

namespace nearpose::compare {

struct FilterFrame {
    int id = 0;
    Observation observation;
    std::optional<Pose> camera_from_world;  // as the arm reports it
    std::optional<evaluation::TrueFrame> truth;
};

// A recording with its truth, read frame by frame.
struct FilterRecording {
    data_set::ModelInfo model;
    int num_frames = 0;
    std::function<FilterFrame(int)> frame;  // throws std::runtime_error naming the file; from several threads at once
};

// The sweep scenario from `far_m` to `near_m`, with its seed.
FilterRecording sweep_recording(const simulate::EmbeddedPart& part, const std::string& part_name, double far_m,
                                double near_m, int num_frames, std::uint64_t seed);

// A BOP scene with true poses. Throws std::runtime_error naming file and cause, also where there is no truth.
FilterRecording scene_recording(const std::filesystem::path& scene, const std::filesystem::path& models, int object_id);

// One of the filters that are compared.
struct ComparedFilter {
    std::string views;  // for labels; `generator` makes them
    std::string method;
    int particles = 200;
    std::shared_ptr<const ViewGenerator> generator;
};

// Errors of translation and rotation of each filter in each frame that has truth, from nothing but the frames. Each
// frame is read once and given to all; time_s is the CPU time of one thread in the update alone. Empty where `go_on`
// says no between two frames. Serial.
std::vector<std::vector<evaluation::FrameErrors>> run_filters(const FilterRecording& recording,
                                                              const std::vector<ComparedFilter>& filters,
                                                              std::uint64_t seed, const std::function<bool()>& go_on);

}  // namespace nearpose::compare
