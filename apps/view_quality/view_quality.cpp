#include "apps/view_quality/view_quality.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "apps/base/thread_time.hpp"
#include "apps/error_measures/run_summary.hpp"
#include "core/base/point_index.hpp"
#include "core/base/random.hpp"

namespace nearpose::compare {
namespace {

// How far particles lie around the truth while the filter works [rad, fraction of the diameter].
constexpr double kParticleRotation_rad = 0.03;
constexpr double kParticleOffsetDiameters = 0.008;
constexpr int kTimedBlock = 10;  // views in a row of one generator

// The stream of this module beside the estimator's and the simulation's own: poses around the true one.
constexpr auto kTimedViewDraw = static_cast<RandomPurpose>(200);

// What the camera sees from one pose, in its full resolution.
struct TrueImage {
    TrueImage(const EmbreeScene& scene, const PinholeCamera& image_camera, const Pose& pose)
        : truth(scene), camera(image_camera), camera_from_object(pose), hits(scene.cast(pose, image_camera)) {}

    PixelBox box() const;
    // The depth of the first surface on the ray through a point before the camera [m]; 0 where there is none.
    double first_depth(const Eigen::Vector3d& point_in_camera) const;

    const EmbreeScene& truth;
    PinholeCamera camera;
    Pose camera_from_object;
    RayHits hits;
};

PixelBox TrueImage::box() const {
    if (hits.pixels.empty()) return {};
    PixelBox box{camera.width, camera.height, 0, 0};
    for (const int pixel : hits.pixels) {
        const int u = pixel % camera.width, v = pixel / camera.width;
        box = {std::min(box.first_u, u), std::min(box.first_v, v), std::max(box.last_u, u + 1),
               std::max(box.last_v, v + 1)};
    }
    return box;
}

double TrueImage::first_depth(const Eigen::Vector3d& point_in_camera) const {
    // A camera of one pixel, whose ray is the one through the point.
    const Eigen::Vector3d ray = point_in_camera / point_in_camera.z();
    const RayHits hit = truth.cast(camera_from_object, {1, 1, 1.0, 1.0, -ray.x(), -ray.y()});
    return hit.size() == 0 ? 0.0 : static_cast<double>(hit.depth_m.front());
}

// Sums over views.
struct Tally {
    std::size_t views = 0, points = 0, pixels = 0, wrong = 0, hidden = 0, missing = 0;
    std::vector<double> distances_m;  // of all points
};

// The grid's outermost squares reach up to half a pixel beyond the image's own.
bool inside_image(const PinholeCamera& camera, const Eigen::Vector3d& point_in_camera) {
    if (!(point_in_camera.z() > 0.0)) return false;
    constexpr double kMargin = 1.5;
    const Eigen::Vector2d uv = camera.project(point_in_camera);
    return uv.x() > -kMargin && uv.y() > -kMargin && uv.x() < camera.width - 1 + kMargin &&
           uv.y() < camera.height - 1 + kMargin;
}

// Adds the points of `view`; true for those that are seen.
std::vector<bool> judge_points(const View& view, const TrueImage& image, Tally& tally) {
    std::vector<bool> seen(view.size(), false);
    std::vector<Eigen::Vector3f> unseen_in_object;
    std::vector<double> along_ray_m;  // from each of these to the first surface on its ray; infinite without one
    for (std::size_t i = 0; i < view.size(); ++i) {
        const Eigen::Vector3d point = image.camera_from_object * view.points_in_object[i].cast<double>();
        const double first = point.z() > 0.0 ? image.first_depth(point) : 0.0;
        const bool inside = inside_image(image.camera, point);
        const double behind = point.z() - first;
        // Along the ray, not the axis.
        const double to_first_m = first > 0.0 ? std::abs(behind) * point.norm() / point.z() : HUGE_VAL;
        seen[i] = inside && first > 0.0 && std::abs(behind) <= kSeenTolerance_m;
        if (seen[i]) {
            tally.distances_m.push_back(to_first_m);
            continue;
        }
        ++tally.wrong;
        if (inside && first > 0.0 && behind > 0.0) ++tally.hidden;
        unseen_in_object.push_back(view.points_in_object[i]);
        along_ray_m.push_back(inside ? to_first_m : HUGE_VAL);
    }
    if (!unseen_in_object.empty()) {
        const auto nearest = PointIndex(image.hits.points_in_object).nearest(unseen_in_object);
        for (std::size_t k = 0; k < nearest.size(); ++k) {
            const double direct_m = std::sqrt(static_cast<double>(nearest[k].squared_distance_m2));
            tally.distances_m.push_back(std::min(direct_m, along_ray_m[k]));
        }
    }
    tally.points += view.size();
    return seen;
}

void judge_pixels(const View& view, const std::vector<bool>& seen, const TrueImage& image,
                  const PinholeCamera& view_camera, Tally& tally) {
    const RayHits expected = image.truth.cast(image.camera_from_object, view_camera);
    std::vector<bool> covered(static_cast<std::size_t>(view_camera.width) *
                              static_cast<std::size_t>(view_camera.height));
    for (std::size_t i = 0; i < view.size(); ++i) {
        if (seen[i]) covered[static_cast<std::size_t>(view.pixels[i])] = true;
    }
    for (const int pixel : expected.pixels) {
        if (!covered[static_cast<std::size_t>(pixel)]) ++tally.missing;
    }
    tally.pixels += expected.size();
}

struct TimedView {
    Pose camera_from_object;
    PinholeCamera camera;
};

std::vector<TimedView> around(const std::vector<TimedView>& views, const ModelExtent& extent, int count) {
    std::vector<TimedView> timed;
    for (int i = 0; i < count; ++i) {
        const TimedView& view = views[static_cast<std::size_t>(i) % views.size()];
        RandomStream random(0, 0, static_cast<std::uint64_t>(i), kTimedViewDraw);
        Twist twist;
        for (int k = 0; k < 6; ++k) {
            twist[k] =
                random.gaussian() * (k < 3 ? kParticleRotation_rad : kParticleOffsetDiameters * extent.diameter_m());
        }
        timed.push_back({perturb_about(view.camera_from_object, twist, extent.centre_in_object()), view.camera});
    }
    return timed;
}

// The two take turns, so that a slower moment of the machine is both their time.
void take_time(const ViewGenerator& views, const EmbreeScene& truth, const std::vector<TimedView>& timed,
               ViewQuality& quality) {
    const double share = 200.0 / static_cast<double>(timed.size());
    for (std::size_t begin = 0; begin < timed.size(); begin += kTimedBlock) {
        const std::size_t end = std::min(begin + kTimedBlock, timed.size());
        const double start_s = thread_cpu_s();
        for (std::size_t i = begin; i < end; ++i) views.generate(timed[i].camera_from_object, timed[i].camera);
        const double middle_s = thread_cpu_s();
        for (std::size_t i = begin; i < end; ++i) truth.cast(timed[i].camera_from_object, timed[i].camera);
        quality.cpu_s_per_200 += share * (middle_s - start_s);
        quality.raycast_cpu_s_per_200 += share * (thread_cpu_s() - middle_s);
    }
}

double ratio(std::size_t part, std::size_t whole) {
    return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
}

ViewQuality summary_of(Tally tally) {
    ViewQuality quality;
    quality.views = static_cast<int>(tally.views);
    quality.points_per_view = ratio(tally.points, tally.views);
    quality.pixels_per_view = ratio(tally.pixels, tally.views);
    quality.wrong_share = ratio(tally.wrong, tally.points);
    quality.hidden_share = ratio(tally.hidden, tally.points);
    quality.missing_share = ratio(tally.missing, tally.pixels);
    const evaluation::Statistics distance = evaluation::statistics_of(std::move(tally.distances_m));
    quality.mean_distance_m = distance.mean;
    quality.distance_95_m = distance.percentile_95;
    quality.max_distance_m = distance.max;
    return quality;
}

}  // namespace

ViewQuality view_quality(const ViewGenerator& views, const EmbreeScene& truth, const ViewTask& task,
                         std::span<const Pose> camera_from_object) {
    Tally tally;
    std::vector<TimedView> seen_views;
    for (const Pose& pose : camera_from_object) {
        const TrueImage image(truth, task.image_camera, pose);
        if (image.hits.size() == 0) continue;
        const PinholeCamera view_camera = camera_of(grid_over(image.box(), task.max_rays), task.image_camera);
        const View view = views.generate(pose, view_camera);
        const std::vector<bool> seen = judge_points(view, image, tally);
        judge_pixels(view, seen, image, view_camera, tally);
        ++tally.views;
        seen_views.push_back({pose, view_camera});
    }
    ViewQuality quality = summary_of(std::move(tally));
    if (!seen_views.empty() && task.timed_views > 0) {
        take_time(views, truth, around(seen_views, truth.extent(), task.timed_views), quality);
    }
    return quality;
}

}  // namespace nearpose::compare
