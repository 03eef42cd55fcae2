// SE(3) for Ceres: 7 numbers in which a pose is stored, 6 in which it is changed. Not installed.
#pragma once

#include <ceres/manifold.h>

#include <Eigen/Core>

#include "core/pose.hpp"

namespace nearpose {

// Ambient: quaternion x y z w (Eigen's order), then translation x y z. Tangent: rotation [rad], then translation, both
// in object axes: Plus(x, delta) = x * exp(delta), Minus(y, x) = log(x^-1 * y).
class Se3Manifold final : public ceres::Manifold {
  public:
    static constexpr int kAmbientSize = 7;
    static constexpr int kTangentSize = 6;
    using Ambient = Eigen::Matrix<double, kAmbientSize, 1>;
    using AmbientFromTangent = Eigen::Matrix<double, kAmbientSize, kTangentSize, Eigen::RowMajor>;
    using TangentFromAmbient = Eigen::Matrix<double, kTangentSize, kAmbientSize, Eigen::RowMajor>;

    static Ambient ambient_from_pose(const Pose& pose);
    static Pose pose_from_ambient(const double* ambient);
    // The derivatives at zero tangent; their product is the identity.
    static AmbientFromTangent plus_jacobian(const double* ambient);
    static TangentFromAmbient minus_jacobian(const double* ambient);

    int AmbientSize() const override { return kAmbientSize; }
    int TangentSize() const override { return kTangentSize; }
    bool Plus(const double* x, const double* delta, double* x_plus_delta) const override;
    bool PlusJacobian(const double* x, double* jacobian) const override;
    bool Minus(const double* y, const double* x, double* y_minus_x) const override;
    bool MinusJacobian(const double* x, double* jacobian) const override;
};

}  // namespace nearpose
