// How alike a part looks to itself after a turn: views of it from all around against views of the turned part.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/camera.hpp"
#include "core/pose.hpp"
#include "core/view_generator.hpp"

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

// Of the rays that meet the part before or after the turn, those on which the two surfaces lie farther apart than the
// tolerance.
struct Likeness {
    int rays = 0, differing = 0;
    double share() const { return rays > 0 ? 1.0 - static_cast<double>(differing) / rays : 0.0; }  // in 0..1
};

// Casts every `stride`-th ray in u and v. Ends as soon as the share must stay below `least_share`, with what it has
// until then, which lies below.
Likeness likeness(const ViewsAround& around, const Pose& turn, double tolerance_m, int stride, double least_share);

// `turn` (object_from_object) after some point-to-plane steps that lay the turned surface on the surface.
Pose refined_turn(const ViewsAround& around, const Pose& turn, double tolerance_m);

// Whether the surface differs anywhere after the turn. A ray agrees if the surface that it meets has a counterpart
// within the tolerance, beside the ray too: contours move by as much as the surface does. Single rays that differ are
// the seams of tessellations; several that lie together are a detail.
bool shows_a_difference(const ViewsAround& around, const Pose& turn, double tolerance_m);

}  // namespace nearpose
