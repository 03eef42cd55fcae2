// The fit of one pose as one writes it first: the surface that is seen is paired with measured points near it, and the
// distances along the model's normals are made small, with Cauchy's weights. It knows no errors of the sensor.
#pragma once

#include "core/base/camera.hpp"
#include "core/base/depth_image.hpp"
#include "core/base/pose.hpp"
#include "tests/bench/naive/single_ray_views.hpp"

namespace nearpose::bench::naive {

// What a point of the model is paired with: the measured point in the pixel that it falls into, or the nearest one.
enum class Pairing { kProjective, kNearest };

struct PlaneFitOptions {
    Pairing pairing = Pairing::kProjective;
    int rounds = 20;         // each with new pairs
    int rounds_a_view = 5;   // the surface that is seen hardly changes from one round to the next
    double gate_m = 0.005;   // a measured point farther away belongs to another surface
    double scale_m = 0.001;  // of Cauchy's weights
};

// Levenberg's method from `start`. Without a mask every measured point within the gate counts.
Pose fit_point_to_plane(const Pose& start, const SingleRayViews& views, const DepthImage& depth, const Mask* mask,
                        const PinholeCamera& camera, const PlaneFitOptions& options = {});

// Of the mask's pixels that have depth, the share on which the model lies within `within_m` along its normal. It is
// the same for every fit, and none of them is made to raise it.
double explained_share(const Pose& camera_from_object, const SingleRayViews& views, const DepthImage& depth,
                       const Mask& mask, const PinholeCamera& camera, double within_m);

}  // namespace nearpose::bench::naive
