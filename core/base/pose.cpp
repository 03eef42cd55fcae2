#include "core/base/pose.hpp"

#include <Eigen/SVD>
#include <cmath>

namespace nearpose {
namespace {

// Below this angle [rad] the closed forms of the coefficients lose digits and their series are exact.
constexpr double kSeriesAngle = 1e-3;

// V(omega) with exp(omega, v) = (Exp(omega), V v): the left Jacobian of SO(3).
Eigen::Matrix3d left_jacobian(const Eigen::Vector3d& omega) {
    const double angle2 = omega.squaredNorm();
    const double angle = std::sqrt(angle2);
    const Eigen::Matrix3d W = skew(omega);
    const double b = angle < kSeriesAngle ? 0.5 - angle2 / 24.0 : (1.0 - std::cos(angle)) / angle2;
    const double c = angle < kSeriesAngle ? 1.0 / 6.0 - angle2 / 120.0 : (angle - std::sin(angle)) / (angle2 * angle);
    return Eigen::Matrix3d::Identity() + b * W + c * W * W;
}

Eigen::Matrix3d left_jacobian_inverse(const Eigen::Vector3d& omega) {
    const double angle2 = omega.squaredNorm();
    const double angle = std::sqrt(angle2);
    const Eigen::Matrix3d W = skew(omega);
    const double half = 0.5 * angle;
    const double c = angle < kSeriesAngle ? 1.0 / 12.0 + angle2 / 720.0 : (1.0 - half / std::tan(half)) / angle2;
    return Eigen::Matrix3d::Identity() - 0.5 * W + c * W * W;
}

Eigen::Quaterniond rotation_exp(const Eigen::Vector3d& omega) {
    const double angle2 = omega.squaredNorm();
    const double angle = std::sqrt(angle2);
    const double s = angle < kSeriesAngle ? 0.5 - angle2 / 48.0 : std::sin(0.5 * angle) / angle;
    return Eigen::Quaterniond(std::cos(0.5 * angle), s * omega.x(), s * omega.y(), s * omega.z()).normalized();
}

Eigen::Vector3d rotation_log(const Eigen::Quaterniond& q) {
    const double sign = q.w() < 0.0 ? -1.0 : 1.0;  // of the two quaternions of one rotation, the shorter way
    const Eigen::Vector3d v = sign * q.vec();
    const double w = sign * q.w();
    const double n = v.norm();
    if (n < 1e-9) return 2.0 / w * v;
    return 2.0 * std::atan2(n, w) / n * v;
}

}  // namespace

Eigen::Matrix3d skew(const Eigen::Vector3d& v) {
    Eigen::Matrix3d matrix;
    matrix << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
    return matrix;
}

Pose Pose::from_matrix(const Eigen::Matrix3d& rotation_matrix, const Eigen::Vector3d& translation) {
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(rotation_matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Eigen::Vector3d signs = Eigen::Vector3d::Ones();
    if ((svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0) signs.z() = -1.0;
    const Eigen::Matrix3d nearest = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
    return {Eigen::Quaterniond(nearest).normalized(), translation};
}

Pose Pose::operator*(const Pose& other) const {
    return {(rotation * other.rotation).normalized(), rotation * other.translation + translation};
}

Pose Pose::inverse() const {
    const Eigen::Quaterniond turned_back = rotation.conjugate();
    return {turned_back, -(turned_back * translation)};
}

Pose exp(const Twist& twist) {
    const Eigen::Vector3d omega = twist.head<3>();
    return {rotation_exp(omega), left_jacobian(omega) * twist.tail<3>()};
}

Twist log(const Pose& pose) {
    const Eigen::Vector3d omega = rotation_log(pose.rotation);
    Twist twist;
    twist << omega, left_jacobian_inverse(omega) * pose.translation;
    return twist;
}

Pose interpolate(const Pose& from, const Pose& to, double fraction) {
    return from * exp(fraction * log(from.inverse() * to));
}

double angle_between(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
    const Eigen::Quaterniond difference = a.conjugate() * b;
    return 2.0 * std::atan2(difference.vec().norm(), std::abs(difference.w()));
}

Pose perturb_about(const Pose& pose, const Twist& twist, const Eigen::Vector3d& centre_in_object) {
    const Eigen::Quaterniond turn = rotation_exp(twist.head<3>());
    const Pose about_centre{turn, centre_in_object - turn * centre_in_object + twist.tail<3>()};
    return pose * about_centre;
}

Twist twist_about(const Pose& from, const Pose& to, const Eigen::Vector3d& centre_in_object) {
    Twist twist;
    twist.head<3>() = log(Pose{from.rotation.conjugate() * to.rotation, Eigen::Vector3d::Zero()}).head<3>();
    twist.tail<3>() = from.rotation.conjugate() * (to * centre_in_object - from * centre_in_object);
    return twist;
}

Matrix6d from_camera_twist(const Pose& camera_from_object, const Eigen::Vector3d& centre_in_object) {
    const Eigen::Matrix3d object_from_camera = camera_from_object.rotation_matrix().transpose();
    Matrix6d map = Matrix6d::Zero();
    map.topLeftCorner<3, 3>() = object_from_camera;
    map.bottomLeftCorner<3, 3>() = -object_from_camera * skew(camera_from_object * centre_in_object);
    map.bottomRightCorner<3, 3>() = object_from_camera;
    return map;
}

bool is_valid(const Pose& pose, double max_translation_m) {
    return pose.rotation.coeffs().allFinite() && pose.translation.allFinite() &&
           std::abs(pose.rotation.norm() - 1.0) < 1e-6 && pose.translation.norm() < max_translation_m;
}

}  // namespace nearpose
