// Modes of the posterior: distinct poses that explain the observation, and alternatives that a pose may be mistaken
// for.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/pose.hpp"
#include "core/view_generator.hpp"

namespace nearpose {

struct Mode {
    Pose camera_from_object;
    double cost = 0.0;                       // smaller is better; 1: as without the object
    double support = 0.0;                    // share of the model's rays that agree with the measured depth, in 0..1
    double log_evidence = 0.0;               // of the present image for it, up to a constant [nats]
    double log_prior = 0.0;                  // what the frames before said of it, against the tracked mode [nats]
    double weight = 0.0;                     // share of the probability, among the modes beside it
    Matrix6d covariance = Matrix6d::Zero();  // of the twist of camera_from_object * exp(twist), rotation first

    double log_posterior() const { return log_evidence + log_prior; }  // up to the same constant
};

// A pose as a mode of which only the cost is known; where not even that is, 1, the worst that a pixel cost has.
inline Mode mode_at(const Pose& camera_from_object, double cost = 1.0) {
    Mode mode;
    mode.camera_from_object = camera_from_object;
    mode.cost = cost;
    return mode;
}

// Two poses closer than both are one mode.
struct ModeDistance {
    double rotation_rad = 0.0;
    double translation_m = 0.0;  // between the model's centres
};

bool same_mode(const Pose& a, const Pose& b, const Eigen::Vector3d& centre_in_object, const ModeDistance& distance);

// The best `max_count` modes that are distinct from each other, best first (ties in the given order). Costs that are
// not finite are left out.
std::vector<Mode> distinct_modes(const std::vector<Mode>& modes, int max_count, const Eigen::Vector3d& centre_in_object,
                                 const ModeDistance& distance);

// Weights of modes by this image and the frames before, summing to 1.
void set_weights(std::vector<Mode>& modes);

// Which changes of a pose are tried as alternatives, about and along the axes of the part's box.
struct AlternativeOptions {
    int steps_per_turn = 4;  // at least 2; turns are multiples of a full one divided by this: parts resemble boxes
    double max_shift = 0.5;  // as a fraction of the box's extent along the axis: a row of bores repeats at its pitch
};

// Poses that a part may be mistaken for: turns through its centre and shifts. `count` random draws from the stream
// (seed, step, 0).
std::vector<Pose> alternatives_of(const Pose& camera_from_object, const ModelExtent& extent, int count,
                                  std::uint64_t seed, std::uint64_t step, const AlternativeOptions& options = {});

}  // namespace nearpose
