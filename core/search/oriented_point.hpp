// Oriented points: points of a surface with their normals, of the model or as measured.
#pragma once

#include <vector>

#include "core/base/pose.hpp"
#include "core/search/search_options.hpp"
#include "core/view_generator.hpp"

namespace nearpose {

// A point of a surface with its unit normal, which points out of the object. Whoever holds one says in which frame: the
// object's for points of the model, the camera's for measured ones.
struct OrientedPoint {
    Eigen::Vector3f point;  // [m]
    Eigen::Vector3f normal;
};

// `count` unit vectors, spread evenly over the sphere.
std::vector<Eigen::Vector3d> directions_all_around(int count);

// camera_from_object of a camera that stands in that direction (unit) from the model's centre and looks at it.
Pose camera_looking_along(const Eigen::Vector3d& direction_in_object, const ModelExtent& extent,
                          double distance_diameters = SurfaceViewOptions{}.distance_diameters);

// Oriented points of the model (in the object's frame), as views from all around show them.
std::vector<OrientedPoint> surface_seen_all_around(const ViewGenerator& views, const SurfaceViewOptions& options);

// Some thousands of them, as many as the options say.
std::vector<OrientedPoint> sample_surface(const ViewGenerator& views, const SurfacePointOptions& options = {});

// camera_from_object that brings a point of the model (in the object's frame) onto a measured one (in camera
// coordinates), normal on normal, and turns the model about that normal.
Pose pose_aligning(const OrientedPoint& model, const OrientedPoint& measured, double turn_rad);

}  // namespace nearpose
