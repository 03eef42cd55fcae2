// Oriented points: places of a surface with their normals, of the model or as measured.
#pragma once

#include <vector>

#include "core/base/pose.hpp"
#include "core/view_generator.hpp"

namespace nearpose {

// A point of the model's surface that can be seen from outside, with its unit normal.
struct OrientedPoint {
    Eigen::Vector3f point;  // [m]
    Eigen::Vector3f normal;
};

// Unit vectors, spread evenly.
std::vector<Eigen::Vector3d> directions_all_around(int count);

// camera_from_object of a camera two diameters from the model's centre in that direction (unit), looking at it.
Pose camera_looking_along(const Eigen::Vector3d& direction_in_object, const ModelExtent& extent);

// The model as seen from two diameters away, whole, on side x side pixels.
View view_from(const ViewGenerator& views, const Eigen::Vector3d& direction_in_object, int side);

// Anchors from views of the model from all around, some thousands of them.
std::vector<OrientedPoint> sample_surface(const ViewGenerator& views);

// camera_from_object that lays an point_of_model on a measured point (in camera coordinates), normal on normal, turned
// about it.
Pose pose_aligning(const OrientedPoint& point_of_model, const OrientedPoint& measured, double turn_rad);

}  // namespace nearpose
