// Rigid transforms and their Lie group SE(3).
//
// Conventions, stated once and tested in tests/core/base/pose_test.cpp:
//   - a transform is named target_from_source: point_in_camera = camera_from_object * point_in_object;
//   - a twist is (rotation [rad], translation [m]), rotation first;
//   - a perturbation acts on the right: pose * exp(twist), that is, in the source's (the object's) axes.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace nearpose {

using Twist = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

// An element of SE(3). The quaternion is kept at unit length by every function below.
struct Pose {
    Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
    Eigen::Vector3d translation = Eigen::Vector3d::Zero();  // [m]

    static Pose identity() { return {}; }
    // Takes the nearest rotation to `rotation_matrix` (polar decomposition), so that matrices read from text files with
    // few digits, or stored as float, become proper.
    static Pose from_matrix(const Eigen::Matrix3d& rotation_matrix, const Eigen::Vector3d& translation);

    Eigen::Vector3d operator*(const Eigen::Vector3d& point) const { return rotation * point + translation; }
    Pose operator*(const Pose& other) const;
    Pose inverse() const;
    Eigen::Matrix3d rotation_matrix() const { return rotation.toRotationMatrix(); }
};

// The exponential map of SE(3) and its inverse; exact to rounding at zero, for tiny angles and near pi.
Pose exp(const Twist& twist);
Twist log(const Pose& pose);

// The geodesic from `from` (fraction 0) to `to` (fraction 1): from * exp(fraction * log(from^-1 * to)). This is what
// the paper writes as multiplication of the gradient with its step size.
Pose interpolate(const Pose& from, const Pose& to, double fraction);

// The matrix of the cross product: skew(v) * w = v x w.
Eigen::Matrix3d skew(const Eigen::Vector3d& v);

// Angle in [0, pi] of the rotation that takes `a` to `b` [rad]. Computed with atan2: an arccos of a trace loses every
// digit below 1e-8 rad and hides matrices that are not rotations.
double angle_between(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b);

// Turns `pose` (camera_from_object) by the rotation of `twist` about `centre_in_object` [m] and moves that centre by
// the twist's translation, both in object axes. A turn about a far origin would move the object by the lever arm.
Pose perturb_about(const Pose& pose, const Twist& twist, const Eigen::Vector3d& centre_in_object);

// The inverse of perturb_about: the twist about the centre, in object axes, that takes `from` to `to`.
Twist twist_about(const Pose& from, const Pose& to, const Eigen::Vector3d& centre_in_object);

// Maps a small motion of the object in camera axes, about the camera, to the twist about its centre in object axes.
Matrix6d from_camera_twist(const Pose& camera_from_object, const Eigen::Vector3d& centre_in_object);

// True if every number is finite, the quaternion is of unit length and the translation shorter than
// `max_translation_m`. A pose from outside is checked with this before it meets a ray caster: a NaN ray ends the
// process.
bool is_valid(const Pose& pose, double max_translation_m = 1e6);

}  // namespace nearpose
