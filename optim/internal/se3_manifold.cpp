#include "optim/internal/se3_manifold.hpp"

namespace nearpose {
namespace {

// d(q * exp(omega)) / d omega at zero: half the quaternion product of q with (omega, 0), rows x y z w.
Eigen::Matrix<double, 4, 3> quaternion_from_rotation(const Eigen::Quaterniond& q) {
    Eigen::Matrix<double, 4, 3> jacobian;
    jacobian << q.w(), -q.z(), q.y(), q.z(), q.w(), -q.x(), -q.y(), q.x(), q.w(), -q.x(), -q.y(), -q.z();
    return 0.5 * jacobian;
}

}  // namespace

Se3Manifold::Ambient Se3Manifold::ambient_from_pose(const Pose& pose) {
    Ambient ambient;
    ambient << pose.rotation.coeffs(), pose.translation;
    return ambient;
}

Pose Se3Manifold::pose_from_ambient(const double* ambient) {
    return {Eigen::Quaterniond(ambient), Eigen::Vector3d(ambient[4], ambient[5], ambient[6])};
}

Se3Manifold::AmbientFromTangent Se3Manifold::plus_jacobian(const double* ambient) {
    const Pose pose = pose_from_ambient(ambient);
    AmbientFromTangent jacobian = AmbientFromTangent::Zero();
    jacobian.topLeftCorner<4, 3>() = quaternion_from_rotation(pose.rotation);
    jacobian.bottomRightCorner<3, 3>() = pose.rotation_matrix();
    return jacobian;
}

Se3Manifold::TangentFromAmbient Se3Manifold::minus_jacobian(const double* ambient) {
    const Pose pose = pose_from_ambient(ambient);
    TangentFromAmbient jacobian = TangentFromAmbient::Zero();
    // The columns of the upper block are orthogonal and of length 1/2, so its inverse is four times its transpose.
    jacobian.topLeftCorner<3, 4>() = 4.0 * quaternion_from_rotation(pose.rotation).transpose();
    jacobian.bottomRightCorner<3, 3>() = pose.rotation_matrix().transpose();
    return jacobian;
}

bool Se3Manifold::Plus(const double* x, const double* delta, double* x_plus_delta) const {
    const Pose moved = pose_from_ambient(x) * exp(Eigen::Map<const Twist>(delta));
    Eigen::Map<Ambient> result(x_plus_delta);
    result = ambient_from_pose(moved);
    return result.allFinite();
}

bool Se3Manifold::PlusJacobian(const double* x, double* jacobian) const {
    Eigen::Map<AmbientFromTangent> result(jacobian);
    result = plus_jacobian(x);
    return result.allFinite();
}

bool Se3Manifold::Minus(const double* y, const double* x, double* y_minus_x) const {
    Eigen::Map<Twist> result(y_minus_x);
    result = log(pose_from_ambient(x).inverse() * pose_from_ambient(y));
    return result.allFinite();
}

bool Se3Manifold::MinusJacobian(const double* x, double* jacobian) const {
    Eigen::Map<TangentFromAmbient> result(jacobian);
    result = minus_jacobian(x);
    return result.allFinite();
}

}  // namespace nearpose
