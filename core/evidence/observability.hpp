// What an observation determines of a pose, and what it leaves open.
#pragma once

#include <string>
#include <vector>

#include "core/base/pose.hpp"
#include "core/shape/symmetry.hpp"

namespace nearpose {

// The principal axes of a pose's covariance, the least determined first. A rotation is measured by how far it moves a
// point at the object's radius, so that all sigmas are lengths [m].
struct Observability {
    Eigen::Matrix<double, 6, 6> directions = Matrix6d::Identity();  // columns: (radius * rotation, translation), unit
    Twist sigmas_m = Twist::Zero();
    // The directions that the observation leaves open by more than the limit, in words and object axes: "slides along
    // x", "turns about z".
    std::vector<std::string> weak;
};

// `covariance` is that of the observation's own fit, of the twist about the model's centre (joint_fit.hpp). Turns about
// axes of revolution, which change nothing, are left out: their sigma is 0.
Observability observability_of(const Matrix6d& covariance, double radius_m, double weak_beyond_m,
                               const Symmetries& symmetries = {},
                               const Eigen::Vector3d& centre_in_object = Eigen::Vector3d::Zero());

// "x" where that axis of the object is within 15 degrees of the direction; otherwise the direction's components.
std::string axis_name(Eigen::Vector3d direction_in_object);

}  // namespace nearpose
