// Where comparisons look from: straight lines onto a point of the part's upper face.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>

#include "apps/simulate/scenario.hpp"
#include "core/pose.hpp"
#include "raycast/embree_scene.hpp"

namespace nearpose::compare {

struct LineOfSight {
    Eigen::Vector3d target_in_object = Eigen::Vector3d::Zero();  // on the surface [m]
    Eigen::Quaterniond object_from_camera = Eigen::Quaterniond::Identity();
};

// Draws the target near one that an approach may aim at, the tilt of the line against the upper face's normal (up to
// 0.45 rad), its direction and the camera's roll. Targets at the bottom of holes are drawn again, so that a camera at
// 0.1 m is not inside of the part.
LineOfSight draw_line_of_sight(const EmbreeScene& scene, const simulate::Part& part, std::uint64_t seed);

// camera_from_object of the camera at this distance of the target, which it has in the middle of its image.
Pose pose_at(const LineOfSight& line, double distance_m);

}  // namespace nearpose::compare
