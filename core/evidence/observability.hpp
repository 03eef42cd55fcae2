// What an observation determines of a pose, and what it leaves open.
#pragma once

#include <string>
#include <vector>

#include "core/base/pose.hpp"

namespace nearpose {

// The spectrum of what one observation says about the pose, in a measure in which a turn counts with the way of a point
// at the object's radius: directions and standard deviations [m], the least determined first.
struct Observability {
    Eigen::Matrix<double, 6, 6> directions = Matrix6d::Identity();  // columns: (radius * rotation, translation), unit
    Twist sigmas_m = Twist::Zero();
    // Directions that the observation leaves open by more than the limit, in words and object axes: "slides along x",
    // "turns about z".
    std::vector<std::string> weak;
};

// `covariance` is of one observation's own fit, about the model's centre (see fine_fit.hpp).
Observability observability_of(const Matrix6d& covariance, double radius_m, double weak_beyond_m);

}  // namespace nearpose
