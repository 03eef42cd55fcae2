#include "core/evidence/observability.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <string>

#include "core/base/text.hpp"

namespace nearpose {
std::string axis_name(Eigen::Vector3d direction) {
    constexpr double kCosine = 0.966;  // of 15 degrees
    direction.normalize();
    Eigen::Index largest = 0;
    direction.cwiseAbs().maxCoeff(&largest);
    if (std::abs(direction[largest]) > kCosine) return std::string(1, "xyz"[largest]);
    if (direction[largest] < 0.0) direction = -direction;
    std::string text = "(";
    for (int i = 0; i < 3; ++i) text += fixed_text(direction[i], 2) + (i < 2 ? " " : ")");
    return text;
}

namespace {

// A motion is named by its larger part. Where neither is twice the other, it is a rotation about an axis outside the
// centre, and both are named.
std::string name_of(const Twist& direction) {
    const double turn = direction.head<3>().norm(), slide = direction.tail<3>().norm();
    if (slide > 2.0 * turn) return "slides along " + axis_name(direction.tail<3>());
    if (turn > 2.0 * slide) return "turns about " + axis_name(direction.head<3>());
    return "turns about " + axis_name(direction.head<3>()) + " while it slides along " + axis_name(direction.tail<3>());
}

}  // namespace

Observability observability_of(const Matrix6d& covariance, double radius_m, double weak_beyond_m,
                               const Symmetries& symmetries, const Eigen::Vector3d& centre_in_object) {
    Twist scale;
    scale << Eigen::Vector3d::Constant(radius_m), Eigen::Vector3d::Ones();
    Matrix6d scaled = scale.asDiagonal() * covariance * scale.asDiagonal();
    for (const AxisOfRevolution& axis : symmetries.continuous) {
        Twist turn;  // about the axis, as it moves the centre
        turn << radius_m * axis.axis_in_object, axis.axis_in_object.cross(centre_in_object - axis.offset_in_object_m);
        const Matrix6d across = Matrix6d::Identity() - turn * turn.transpose() / turn.squaredNorm();
        scaled = across * scaled * across.transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(0.5 * (scaled + scaled.transpose()));
    Observability result;
    for (int k = 0; k < 6; ++k) {  // the solver's are in ascending order
        result.directions.col(k) = solver.eigenvectors().col(5 - k);
        result.sigmas_m[k] = std::sqrt(std::max(0.0, solver.eigenvalues()[5 - k]));
        if (result.sigmas_m[k] > weak_beyond_m) result.weak.push_back(name_of(result.directions.col(k)));
    }
    return result;
}

}  // namespace nearpose
