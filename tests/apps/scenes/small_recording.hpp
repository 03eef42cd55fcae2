// Small recordings of the built-in engine block: what the tests of tasks share.
#pragma once

#include "apps/scenes/parts.hpp"
#include "apps/scenes/recording.hpp"

namespace nearpose::simulate {

inline constexpr PinholeCamera kCamera{160, 120, 150.0, 150.0, 79.5, 59.5};

inline const EmbeddedPart& block() {
    static const EmbeddedPart part = embedded_part("engine_block");
    return part;
}

inline Eigen::Vector3d eye_of(const Pose& camera_from_object) {
    return camera_from_object.inverse().translation;
}

inline RecordingOptions small(Scenario scenario, int frames, std::uint64_t seed = 1) {
    RecordingOptions options;
    options.scenario = scenario;
    options.num_frames = frames;
    options.seed = seed;
    options.camera = kCamera;
    options.part_name = "engine_block";
    return options;
}

}  // namespace nearpose::simulate
