#include "core/shape/symmetry.hpp"

#include <algorithm>
#include <cmath>

namespace nearpose {
namespace {

// Elements of a group of turns differ by 30 degrees (12-fold) or more; what is found of them is good to a degree.
constexpr double kSameTurn_rad = 0.09;

// The angle of the turn about `axis` that comes nearest to `rotation`: the twist of its swing-twist decomposition.
double twist_angle(const Eigen::Quaterniond& rotation, const Eigen::Vector3d& axis) {
    return 2.0 * std::atan2(rotation.vec().dot(axis), rotation.w());
}

// Revolution about two different axes is revolution about every axis through their common point.
bool is_ball(const Symmetries& symmetries) {
    const auto crosses_first = [&](const AxisOfRevolution& axis) {
        return axis.axis_in_object.cross(symmetries.continuous.front().axis_in_object).norm() > kSameTurn_rad;
    };
    return std::any_of(symmetries.continuous.begin(), symmetries.continuous.end(), crosses_first);
}

// The point that all axes pass through, in the least squares' sense.
Eigen::Vector3d ball_centre(const Symmetries& symmetries) {
    Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    for (const AxisOfRevolution& axis : symmetries.continuous) {
        const Eigen::Matrix3d across =
            Eigen::Matrix3d::Identity() - axis.axis_in_object * axis.axis_in_object.transpose();
        A += across;
        b += across * axis.offset_in_object_m;
    }
    return A.inverse() * b;
}

}  // namespace

Pose turn_about(const AxisOfRevolution& axis, double angle_rad) {
    const Eigen::Quaterniond rotation(Eigen::AngleAxisd(angle_rad, axis.axis_in_object));
    return {rotation, axis.offset_in_object_m - rotation * axis.offset_in_object_m};
}

bool same_turn(const Pose& a, const Pose& b) {
    return angle_between(a.rotation, b.rotation) < kSameTurn_rad;
}

bool contains(const Symmetries& symmetries, const Pose& turn) {
    if (!symmetries.continuous.empty() && is_ball(symmetries)) return true;
    std::vector<Pose> listed = {Pose::identity()};
    listed.insert(listed.end(), symmetries.discrete.begin(), symmetries.discrete.end());
    return std::any_of(listed.begin(), listed.end(), [&](const Pose& symmetry) {
        if (same_turn(symmetry, turn)) return true;
        const Eigen::Quaterniond rest = symmetry.rotation.conjugate() * turn.rotation;
        return std::any_of(symmetries.continuous.begin(), symmetries.continuous.end(), [&](const auto& axis) {
            return same_turn(turn_about(axis, twist_angle(rest, axis.axis_in_object)), {rest, {}});
        });
    });
}

std::vector<Pose> closed_under_products(const std::vector<Pose>& generators, int max_count) {
    std::vector<Pose> elements;
    const auto is_new = [&](const Pose& turn) {
        return !same_turn(turn, Pose::identity()) &&
               std::none_of(elements.begin(), elements.end(), [&](const Pose& e) { return same_turn(e, turn); });
    };
    for (const Pose& generator : generators)
        if (is_new(generator)) elements.push_back(generator);
    for (std::size_t i = 0; i < elements.size(); ++i) {
        for (const Pose& generator : generators) {
            const Pose product = elements[i] * generator;
            if (static_cast<int>(elements.size()) < max_count && is_new(product)) elements.push_back(product);
        }
    }
    return elements;
}

Pose nearest_equivalent(const Pose& camera_from_object, const Pose& reference, const Symmetries& symmetries,
                        const Eigen::Vector3d& centre_in_object) {
    if (!symmetries.continuous.empty() && is_ball(symmetries)) {
        const Eigen::Vector3d centre = ball_centre(symmetries);
        return {reference.rotation, camera_from_object * centre - reference.rotation * centre};
    }
    // Among nearly equal ones the first stays: applied to its own result the function changes nothing.
    constexpr double kEqual_rad = 1e-9, kEqual_m = 1e-12;
    const auto distance_m = [&](const Pose& pose) {
        return (pose * centre_in_object - reference * centre_in_object).norm();
    };
    Pose nearest = camera_from_object;
    const auto consider = [&](const Pose& pose) {
        const double gain_rad =
            angle_between(nearest.rotation, reference.rotation) - angle_between(pose.rotation, reference.rotation);
        const bool closer = distance_m(pose) < distance_m(nearest) - kEqual_m;
        if (gain_rad > kEqual_rad || (gain_rad > -kEqual_rad && closer)) nearest = pose;
    };
    std::vector<Pose> equals = {camera_from_object};
    for (const Pose& symmetry : symmetries.discrete) equals.push_back(camera_from_object * symmetry);
    for (const Pose& pose : equals) {
        consider(pose);
        for (const AxisOfRevolution& axis : symmetries.continuous) {
            const Eigen::Quaterniond wanted = pose.rotation.conjugate() * reference.rotation;
            consider(pose * turn_about(axis, twist_angle(wanted, axis.axis_in_object)));
        }
    }
    return nearest;
}

}  // namespace nearpose
