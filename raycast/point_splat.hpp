// Points projected onto a depth buffer; shared by the generators that do not cast rays.
#pragma once

#include "core/base/camera.hpp"
#include "core/base/pose.hpp"
#include "core/view_generator.hpp"
#include "raycast/surface_samples.hpp"

namespace nearpose {

// The nearest of the points that fall into a pixel is kept, the first where several are equally near. Pixels ascend;
// normals are turned towards the camera. Throws std::invalid_argument if the pose or the camera is not valid.
View nearest_points(const SurfaceSamples& samples, const Pose& camera_from_object, const PinholeCamera& camera);

}  // namespace nearpose
