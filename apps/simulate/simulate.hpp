// Simulated recordings: a part, a camera's path, a depth sensor with its faults, and an arm that reports its motion,
// written as a BOP data set.
#pragma once

#include <filesystem>
#include <functional>

#include "apps/simulate/arm.hpp"
#include "apps/simulate/scenario.hpp"
#include "apps/simulate/sensor_noise.hpp"
#include "core/camera.hpp"
#include "raycast/mesh.hpp"

namespace nearpose::simulate {

// 640 x 480 at a field of view of 56 x 44 degrees.
PinholeCamera default_camera();

struct SimulationOptions {
    std::filesystem::path data_set;
    bool replace = false;  // a data set that is there already
    Scenario scenario = Scenario::kPiston;
    int num_frames = 60;
    double frames_per_second = 30.0;
    std::uint64_t seed = 1;
    PinholeCamera camera = default_camera();
    double depth_scale_mm = 0.1;  // millimetres per count of the depth images
    SensorNoise sensor;           // already scaled
    ArmErrors arm;
    bool with_table = true;
    int num_threads = 0;  // 0: as many as the machine has
};

struct SimulationSummary {
    bool complete = false;        // false: stopped by `frame_done`, nothing was written
    int frames_without_part = 0;  // no depth was measured on the part: out of view or out of range
};

// Writes test/000001/{depth, mask, mask_visib, scene_*.json}, camera.json, models, models_eval,
// test_targets_bop19.json and truth.tum (camera_from_object). The same options, but for the number of threads, give the
// same bytes on one machine. `frame_done` is called once a frame, never twice at the same time, and returns false to
// stop. Throws std::invalid_argument for options out of bounds and std::runtime_error where files cannot be written.
SimulationSummary write_data_set(const Mesh& mesh, const Part& part, const SimulationOptions& options,
                                 const std::function<bool()>& frame_done);

}  // namespace nearpose::simulate
