// What is carried from one observation to the next.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/filter/particles.hpp"
#include "core/fit/track.hpp"
#include "core/observation/image_sample.hpp"
#include "core/shape/modes.hpp"
#include "core/update/alternatives.hpp"
#include "core/update/phase.hpp"
#include "core/world/sighting.hpp"

namespace nearpose {

// A plain value: it can be copied, kept and put back. A new one knows nothing.
struct Belief {
    ParticleSet particles;
    std::optional<Mode> tracked;            // the estimate of the last update
    std::vector<Alternative> alternatives;  // that it may be mistaken for, likeliest first; the default method's
    std::optional<Track> track;             // the same with its spread; the default method's
    std::optional<Pose> pose_before_loss;   // camera_from_object; from a search on until the track is confirmed again
    Sightings sightings;                    // by which image and arm are compared; the default method's
    ImageMemory image;                      // to notice that the image is the one before
    Lock lock;                              // how well the tracked pose is established
    std::uint64_t step = 0;                 // updates so far; addresses the random streams
};

}  // namespace nearpose
