// How well a model agrees with itself after a turn: views of it from all around against views of the turned model.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/base/camera.hpp"
#include "core/base/pose.hpp"
#include "core/view_generator.hpp"
#include "raycast/symmetry/symmetry_search_options.hpp"

namespace nearpose {

// What one camera sees, by its pixels.
struct SeenPixels {
    std::vector<Eigen::Vector3f> points_in_object;   // [m]
    std::vector<Eigen::Vector3f> normals_in_object;  // unit; zero where the ray misses
    bool hit(int pixel) const { return !normals_in_object[static_cast<std::size_t>(pixel)].isZero(); }
};

// The model from evenly spread directions, whole in each view. `views` must outlive it.
struct ViewsAround {
    const ViewGenerator* views = nullptr;
    PinholeCamera camera;
    std::vector<Pose> cameras_from_object;
    std::vector<SeenPixels> seen;  // one for each camera
    int hits = 0;                  // over all cameras

    double distance_m() const;  // from each camera to the centre of the model's box
};

ViewsAround look_from_all_around(const ViewGenerator& views, int directions, int pixels_across);

// Counts over the rays that meet the model before or after the turn.
struct SelfAgreement {
    int rays = 0;
    int differing = 0;  // of them: only one of the two surfaces is met, or they lie farther apart than the tolerance

    double share() const { return rays > 0 ? 1.0 - static_cast<double>(differing) / rays : 0.0; }  // in 0..1
};

// Casts every `stride`-th ray in u and v. Ends early once the share will surely stay below `least_share`; what it then
// returns lies below it too.
SelfAgreement self_agreement(const ViewsAround& around, const Pose& turn, double tolerance_m, int stride,
                             double least_share);

// `turn` (object_from_object) after some steps of point-to-plane alignment of the turned surface with the surface.
Pose refined_turn(const ViewsAround& around, const Pose& turn, double tolerance_m,
                  const AxisRefinementOptions& options);

// Whether the surface differs anywhere after the turn. On a ray it agrees if what the ray meets has a counterpart
// within the tolerance, on the ray or beside it: contours move by as much as the surface does. Single rays that differ
// are the seams of tessellations; several that lie together are a detail.
bool shows_a_difference(const ViewsAround& around, const Pose& turn, double tolerance_m,
                        const DifferenceOptions& options);

}  // namespace nearpose
