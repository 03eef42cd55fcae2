#include "optim/internal/normalised_pairs.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace nearpose {
namespace {

constexpr double kSmallestLength_m = 1e-6;  // pairs in one point leave the rotation open; no division by zero

}  // namespace

NormalisedPairs::NormalisedPairs(const Correspondences& correspondences, ResidualKind kind) {
    const std::size_t n = correspondences.size();
    const bool with_normals = kind == ResidualKind::kPointToPlane;
    assert(correspondences.points_in_camera.size() == n && correspondences.sigmas_m.size() == n);
    assert(!with_normals || correspondences.normals_in_object.size() == n);
    usable = n > 0 && set_frame(correspondences, with_normals);
    if (!usable) return;

    blocks.resize((n + kLanes - 1) / kLanes);
    const double per_length = 1.0 / length_m;
    for (std::size_t k = 0; k < n; ++k) {
        Block& block = blocks[k / kLanes];
        const auto lane = static_cast<Eigen::Index>(k % kLanes);
        const double weight = length_m / static_cast<double>(correspondences.sigmas_m[k]);
        for (int axis = 0; axis < 3; ++axis) {
            const double in_object = static_cast<double>(correspondences.points_in_object[k][axis]);
            block.point_in_object(lane, axis) = (in_object - centre_in_object[axis]) * per_length;
            block.point_in_camera(lane, axis) =
                static_cast<double>(correspondences.points_in_camera[k][axis]) * per_length;
            if (with_normals) {
                const double normal = static_cast<double>(correspondences.normals_in_object[k][axis]);
                block.weighted_normal(lane, axis) = weight * normal;
            }
        }
        block.weight[lane] = weight;
        total_squared_weight += weight * weight;
    }
}

// Centre and length; false if a number is not usable.
bool NormalisedPairs::set_frame(const Correspondences& correspondences, bool with_normals) {
    // A sum of floats in double cannot overflow, so it is finite if and only if all of them are.
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    Eigen::Vector3d others = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3f& point : correspondences.points_in_object) sum += point.cast<double>();
    for (const Eigen::Vector3f& point : correspondences.points_in_camera) others += point.cast<double>();
    if (with_normals) {
        for (const Eigen::Vector3f& normal : correspondences.normals_in_object) others += normal.cast<double>();
    }
    const bool sigmas_usable = std::all_of(correspondences.sigmas_m.begin(), correspondences.sigmas_m.end(),
                                           [](float sigma_m) { return sigma_m > 0.0f && std::isfinite(sigma_m); });
    if (!sigmas_usable || !sum.allFinite() || !others.allFinite()) return false;

    const auto n = static_cast<double>(correspondences.size());
    centre_in_object = sum / n;
    double squares = 0.0;
    for (const Eigen::Vector3f& point : correspondences.points_in_object) {
        squares += (point.cast<double>() - centre_in_object).squaredNorm();
    }
    length_m = std::max(std::sqrt(squares / n), kSmallestLength_m);
    return true;
}

Pose NormalisedPairs::normalised(const Pose& camera_from_object) const {
    return {camera_from_object.rotation, (camera_from_object * centre_in_object) / length_m};
}

Pose NormalisedPairs::metric(const Pose& normalised_pose) const {
    const Eigen::Quaterniond rotation = normalised_pose.rotation.normalized();
    return {rotation, length_m * normalised_pose.translation - rotation * centre_in_object};
}

}  // namespace nearpose
