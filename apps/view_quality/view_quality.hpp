// How good views are by themselves: a generator's points against what a camera at the pose really sees.
#pragma once

#include <span>

#include "core/base/camera.hpp"
#include "core/base/pose.hpp"
#include "core/view_generator.hpp"
#include "raycast/embree_scene.hpp"

namespace nearpose::compare {

// A point counts as seen where its depth is that of the first surface on its own ray, to within this. The ray goes
// through the point itself, so that slopes need no allowance; what remains is rounding, and surfaces less than this
// behind another.
inline constexpr double kSeenTolerance_m = 0.001;

struct ViewTask {
    PinholeCamera image_camera;  // the depth camera
    int max_rays = 64 * 48;      // of a view: its grid lies over the pixels that show the part, as the filter's does
    int timed_views = 200;       // 0: the time is not taken
};

// Measures over all points and pixels of the views at several poses.
struct ViewQuality {
    int views = 0;                 // poses that show the part; the others do not count
    double points_per_view = 0.0;  // that the generator gave
    double pixels_per_view = 0.0;  // of the grid whose rays meet the part
    double wrong_share = 0.0;      // of the points, 0..1: not seen from the pose, hidden or out of the image
    double hidden_share = 0.0;     // of the points: of the wrong ones those behind the first surface on their ray
    double missing_share = 0.0;    // of the pixels, 0..1: they meet the part, but have no point that is seen
    // From each point to the surface that is seen. Exact for points that are seen; the others' is the distance to the
    // nearest point of a dense image of `image_camera`: never too short, and at most one of its pixels too long.
    double mean_distance_m = 0.0, distance_95_m = 0.0, max_distance_m = 0.0;
    // CPU time of one thread for 200 views at poses as particles have them, of this generator and of ray casting.
    double cpu_s_per_200 = 0.0, raycast_cpu_s_per_200 = 0.0;
};

// `truth` must be of the same model as `views`. Serial. Throws std::invalid_argument for a camera or pose that is not
// valid.
ViewQuality view_quality(const ViewGenerator& views, const EmbreeScene& truth, const ViewTask& task,
                         std::span<const Pose> camera_from_object);

}  // namespace nearpose::compare
