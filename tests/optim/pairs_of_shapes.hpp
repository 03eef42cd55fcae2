// Pairs of known shapes for the tests of the solvers.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <random>
#include <vector>

#include "core/base/pose.hpp"
#include "core/filter/association.hpp"

namespace nearpose::testing_shapes {

inline void add_pair(Correspondences& pairs, const Eigen::Vector3d& in_object, const Eigen::Vector3d& normal,
                     const Eigen::Vector3d& in_camera, double sigma_m) {
    pairs.points_in_object.push_back(in_object.cast<float>());
    pairs.normals_in_object.push_back(normal.cast<float>());
    pairs.points_in_camera.push_back(in_camera.cast<float>());
    pairs.sigmas_m.push_back(static_cast<float>(sigma_m));
}

inline Eigen::Vector3d random_vector(std::mt19937& random) {
    std::normal_distribution<double> normal;
    const double x = normal(random), y = normal(random), z = normal(random);
    return {x, y, z};
}

inline Twist make_twist(double rx, double ry, double rz, double x, double y, double z) {
    Twist twist;
    twist << rx, ry, rz, x, y, z;
    return twist;
}

// A pose that takes multiples of kGrid_m to numbers that a float holds exactly: the quaternion (1, 2, 3, 4) has the
// squared norm 30, so that 30 R is a matrix of integers. Noise-free pairs are then free of rounding too.
constexpr double kGrid_m = 30.0 / (1 << 20);
inline Pose exact_pose() {
    return {Eigen::Quaterniond(1.0, 2.0, 3.0, 4.0).normalized(), Eigen::Vector3d(0.03125, -0.0625, 0.25)};
}

// An ellipsoid of 6 x 4 x 9 cm half axes, on the grid; `origin_in_object` shifts it within its frame.
inline Correspondences ellipsoid_pairs(int count, const Pose& camera_from_object, double noise_sigmas = 0.0,
                                       const Eigen::Vector3d& origin_in_object = Eigen::Vector3d::Zero()) {
    std::mt19937 random(11);
    const Eigen::Vector3d axes(0.06, 0.04, 0.09);
    Correspondences pairs;
    for (int k = 0; k < count; ++k) {
        const Eigen::Vector3d direction = random_vector(random).normalized();
        const Eigen::Vector3d on_surface = direction.cwiseProduct(axes) + origin_in_object;
        const Eigen::Vector3d point = kGrid_m * (on_surface / kGrid_m).array().round().matrix();
        const double sigma_m = k % 2 == 0 ? 0.001 : 0.002;
        const Eigen::Vector3d noise = noise_sigmas * sigma_m * random_vector(random);
        add_pair(pairs, point, direction.cwiseQuotient(axes).normalized(), camera_from_object * point + noise, sigma_m);
    }
    return pairs;
}

// A square of 16 cm with the given normal through the object's origin; every point has this very normal.
inline Correspondences plane_pairs(const Eigen::Vector3d& normal, const Pose& camera_from_object) {
    const Eigen::Vector3d unit = normal.normalized();
    const Eigen::Vector3d u = unit.unitOrthogonal(), v = unit.cross(u);
    Correspondences pairs;
    for (int i = -8; i <= 8; ++i) {
        for (int j = -8; j <= 8; ++j) {
            const Eigen::Vector3d point = 0.01 * (i * u + j * v);
            add_pair(pairs, point, unit, camera_from_object * point, 0.001);
        }
    }
    return pairs;
}

// Rotation [rad] and distance [m] by which two poses of an object near its frame's origin differ.
inline double rotation_error(const Pose& a, const Pose& b) {
    return angle_between(a.rotation, b.rotation);
}
inline double translation_error(const Pose& a, const Pose& b) {
    return (a.translation - b.translation).norm();
}

}  // namespace nearpose::testing_shapes
