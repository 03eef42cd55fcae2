// What a camera would deliver of a part, with its truth, kept in memory: the soak feeds pieces of it.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "apps/scenes/recording.hpp"
#include "core/view_generator.hpp"

namespace nearpose::soak {

struct Frame {
    PinholeCamera camera;
    DepthImage depth;
    Mask mask;
    Pose camera_from_object, camera_from_world;
    bool shows_part = false;
};

struct Recordings {
    std::shared_ptr<const ViewGenerator> views;  // of the part
    std::vector<std::vector<Frame>> frames;      // of cameras of several sizes
    std::vector<Frame> without_part;             // walls, noise and the like
};

Recordings make_recordings(std::uint64_t seed);

}  // namespace nearpose::soak
