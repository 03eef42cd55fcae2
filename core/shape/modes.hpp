// Modes of the posterior: distinct poses that explain the observation, and the rivals of a pose.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/pose.hpp"
#include "core/view_generator.hpp"

namespace nearpose {

struct Mode {
    Pose camera_from_object;
    double cost = 0.0;                       // smaller is better
    double support = 0.0;                    // share of the model's rays that agree with the measured depth, in 0..1
    double log_evidence = 0.0;               // what the present image says for it, up to a constant [nats]
    double weight = 0.0;                     // share of the probability, among the modes beside it
    Matrix6d covariance = Matrix6d::Zero();  // of the twist of camera_from_object * exp(twist), rotation first
};

// A pose whose cost is not known yet: the worst that a pixel cost has.
Mode unweighed_mode(const Pose& camera_from_object);

// Two poses closer than both are one mode.
struct ModeDistance {
    double rotation_rad = 0.2;
    double translation_m = 0.02;  // between the model's centres
};

bool same_mode(const Pose& a, const Pose& b, const Eigen::Vector3d& centre_in_object, const ModeDistance& distance);

// The best `max_count` modes that are distinct from each other, best first (ties in the given order). Costs that are
// not finite are left out.
std::vector<Mode> distinct_modes(const std::vector<Mode>& modes, int max_count, const Eigen::Vector3d& centre_in_object,
                                 const ModeDistance& distance);

// Weights of modes by their evidence, summing to 1.
void set_weights(std::vector<Mode>& modes);

// Poses that a part may be mistaken for: quarter and half turns about the axes of its box, through its centre, and
// shifts along them of up to half its extent (a row of bores repeats at its pitch). `count` random draws from the
// stream (seed, step, 0).
std::vector<Pose> alternatives_of(const Pose& camera_from_object, const ModelExtent& extent, int count,
                                  std::uint64_t seed, std::uint64_t step);

}  // namespace nearpose
