// The least squares step as one writes it first: Ceres, one automatically differentiated residual block a pair.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/base/pose.hpp"
#include "core/base/random.hpp"

namespace nearpose::bench::naive {

struct Pair {
    Eigen::Vector3d point_in_object;   // [m]
    Eigen::Vector3d normal_in_object;  // unit
    Eigen::Vector3d point_in_camera;   // measured [m]
    double sigma_m = 1e-3;             // of the measured depth [m]
};

// Three residuals a pair: the difference of its points.
Pose solve_point_to_point(const std::vector<Pair>& pairs, const Pose& camera_from_object);
// One a pair: that difference along the model's normal, in sigmas, with Huber's loss beyond two of them.
Pose solve_point_to_plane(const std::vector<Pair>& pairs, const Pose& camera_from_object);

// The pairs that the best of `hypotheses` motions of three random pairs (by singular values, Umeyama 1991) supports.
std::vector<Pair> sample_consensus(const std::vector<Pair>& pairs, int hypotheses, double max_distance_m,
                                   RandomStream random);

}  // namespace nearpose::bench::naive
