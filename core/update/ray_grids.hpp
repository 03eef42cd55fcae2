// The pixels through which rays are cast: where in the image the object may be.
#pragma once

#include <optional>

#include "core/base/camera.hpp"
#include "core/update/frame.hpp"

namespace nearpose {

// Where the object may be: around the segmented pixels. Where nothing is segmented: around a pose (camera_from_object),
// or without one around all that was measured. With a margin, so that model beyond what is seen can show.
PixelGrid ray_grid(const Frame& frame, const std::optional<Pose>& around, int max_rays);

// The part of the image in which the model lies at a pose, without a margin; where it comes close to the camera, all
// that was measured.
PixelGrid ray_grid_on_model(const Frame& frame, const Pose& camera_from_object, int max_rays);

// Where the model meets what was measured: a fit has no use for other rays.
PixelGrid ray_grid_to_fit(const Frame& frame, const Pose& camera_from_object, int max_rays);

}  // namespace nearpose
