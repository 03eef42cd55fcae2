// Simulated recordings: a part, a camera's path, a depth sensor with its faults, and an arm that reports its motion,
// written as a BOP data set.
#pragma once

#include <filesystem>
#include <functional>

#include "apps/scenes/recording.hpp"
#include "core/shape/symmetry.hpp"
#include "raycast/mesh.hpp"

namespace nearpose::simulate {

struct SimulationOptions {
    std::filesystem::path data_set;
    bool replace = false;  // a data set that is there already
    RecordingOptions recording;
    bool find_symmetries = true;  // of every model, for models_info.json; by ray casting, as `nearpose import` does
    int num_threads = 0;          // 0: as many as the machine has
};

struct SimulationSummary {
    bool complete = false;        // false: stopped by `frame_done`, nothing was written
    int frames_without_part = 0;  // no depth was measured on the part: out of view or out of range
    Symmetries symmetries;        // found of the tracked part; the exact ones are in models_info.json
};

// Writes test/000001/{depth, mask, mask_visib, scene_*.json}, camera.json, models, models_eval,
// test_targets_bop19.json and truth.tum (camera_from_object of the tracked part, which is the first in the ground
// truth). The tracked part's mask_visib is the given mask, with its errors. For a built-in part the models are all of
// them; models_info.json has the exact symmetries found. With keep_infrared also test/000001/infrared_left and _right.
// The same options, but for the number of threads, give the same bytes on one machine. `frame_done` is called once a
// frame, never twice at the same time, and returns false to stop. Throws std::invalid_argument for options out of
// bounds and std::runtime_error where files cannot be written.
SimulationSummary write_data_set(const Mesh& mesh, const Part& part, const SimulationOptions& options,
                                 const std::function<bool()>& frame_done);

}  // namespace nearpose::simulate
