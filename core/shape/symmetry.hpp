// Symmetries of a part: turns after which a depth camera sees the same.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/base/pose.hpp"

namespace nearpose {

// A full turn about an axis that changes nothing.
struct AxisOfRevolution {
    Eigen::Vector3d axis_in_object = Eigen::Vector3d::UnitZ();     // unit
    Eigen::Vector3d offset_in_object_m = Eigen::Vector3d::Zero();  // a point of the axis
};

// The part looks the same after every product of a discrete turn and turns about the axes of revolution. Where turns
// about these axes make discrete turns equal, one of them is listed.
struct Symmetries {
    std::vector<Pose> discrete;  // object_from_object; the identity is not listed
    std::vector<AxisOfRevolution> continuous;
    // object_from_object: turns after which all but a detail looks the same, so that one pose is mistaken for another.
    std::vector<Pose> near_symmetries;

    bool empty() const { return discrete.empty() && continuous.empty(); }
};

// The turn about an axis: object_from_object.
Pose turn_about(const AxisOfRevolution& axis, double angle_rad);

// Two turns of a rigid part that rotate alike are one: a finite part has no symmetry that shifts it.
bool same_turn(const Pose& a, const Pose& b);

// Whether `turn` (object_from_object) is among the symmetries or a product of one with a turn about an axis of
// revolution; so is the identity.
bool contains(const Symmetries& symmetries, const Pose& turn);

// All products of `generators`, without the identity and each once, as long as there are at most `max_count`.
std::vector<Pose> closed_under_products(const std::vector<Pose>& generators, int max_count);

// The pose nearest to `reference` among all in which the part looks as in `camera_from_object`: by the angle between
// the rotations, then by the distance of the centres.
Pose nearest_equivalent(const Pose& camera_from_object, const Pose& reference, const Symmetries& symmetries,
                        const Eigen::Vector3d& centre_in_object);

}  // namespace nearpose
