#include "raycast/symmetry/self_similarity.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/search/oriented_point.hpp"

namespace nearpose {
namespace {

SeenPixels look(const ViewGenerator& views, const Pose& camera_from_object, const PinholeCamera& camera) {
    const View view = views.generate(camera_from_object, camera);
    const auto pixels = static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
    SeenPixels seen{std::vector<Eigen::Vector3f>(pixels, Eigen::Vector3f::Zero()),
                    std::vector<Eigen::Vector3f>(pixels, Eigen::Vector3f::Zero())};
    for (std::size_t k = 0; k < view.size(); ++k) {
        const auto pixel = static_cast<std::size_t>(view.pixels[k]);
        seen.points_in_object[pixel] = view.points_in_object[k];
        seen.normals_in_object[pixel] = view.normals_in_object[k];
    }
    return seen;
}

struct SurfacePoint {
    Eigen::Vector3d point, normal;
};

SurfacePoint surface_at(const SeenPixels& seen, int pixel) {
    const auto index = static_cast<std::size_t>(pixel);
    return {seen.points_in_object[index].cast<double>(), seen.normals_in_object[index].cast<double>()};
}

SurfacePoint moved(const Pose& turn, const SurfacePoint& surface) {
    return {turn * surface.point, turn.rotation * surface.normal};
}

// By the distances from each point to the plane of the other: along a grazing ray only one of the two is large.
bool close(const SurfacePoint& a, const SurfacePoint& b, double tolerance_m) {
    const Eigen::Vector3d between = a.point - b.point;
    return std::abs(a.normal.dot(between)) <= tolerance_m && std::abs(b.normal.dot(between)) <= tolerance_m;
}

PixelGrid every_ray(const PinholeCamera& camera, int stride) {
    const int first = (stride - 1) / 2;
    return {first, first, stride, (camera.width - first + stride - 1) / stride,
            (camera.height - first + stride - 1) / stride};
}

// Whether a camera sees `surface` on one of the rays that pass it at most `offset_m` away.
bool seen_beside(const ViewGenerator& views, const Pose& camera_from_object, const SurfacePoint& surface,
                 double offset_m) {
    constexpr int kSide = 5;  // rays across
    const Eigen::Vector3d in_camera = camera_from_object * surface.point;
    const double focal = in_camera.z() / offset_m * (kSide / 2), middle = kSide / 2;
    const PinholeCamera camera{kSide,
                               kSide,
                               focal,
                               focal,
                               middle - focal * in_camera.x() / in_camera.z(),
                               middle - focal * in_camera.y() / in_camera.z()};
    const View view = views.generate(camera_from_object, camera);
    for (std::size_t k = 0; k < view.size(); ++k) {
        const SurfacePoint other{view.points_in_object[k].cast<double>(), view.normals_in_object[k].cast<double>()};
        if (close(surface, other, 1.5 * offset_m)) return true;  // 1.5: a curved surface is met at another depth
    }
    return false;
}

// A camera that looks at `surface` along its normal, from so near that hardly anything comes between.
Pose camera_facing(const SurfacePoint& surface, double offset_m) {
    const auto rotation = Eigen::Quaterniond::FromTwoVectors(-surface.normal, Eigen::Vector3d::UnitZ());
    return {rotation, Eigen::Vector3d(0, 0, 10.0 * offset_m) - rotation * surface.point};
}

// The two surfaces on one ray, both in the frame of the part before the turn.
struct RayPair {
    bool hit_before = false, hit_after = false;
    SurfacePoint before, after;
};

RayPair pair_on(const SeenPixels& before, int pixel_before, const SeenPixels& after, int pixel_after,
                const Pose& turn) {
    RayPair pair{before.hit(pixel_before), after.hit(pixel_after), {}, {}};
    if (pair.hit_before) pair.before = surface_at(before, pixel_before);
    if (pair.hit_after) pair.after = moved(turn, surface_at(after, pixel_after));
    return pair;
}

// For a ray on which the surfaces lie apart: whether the nearer one has its counterpart beside the ray. A surface that
// the ray grazes is too narrow in the image to be met there, so it is also looked at along its normal.
bool has_counterpart_beside(const ViewGenerator& views, const Pose& camera_from_object, const Pose& turn,
                            const RayPair& pair, double tolerance_m) {
    const auto depth_m = [&](const SurfacePoint& surface) { return (camera_from_object * surface.point).z(); };
    const bool before_is_nearer = pair.hit_before && (!pair.hit_after || depth_m(pair.before) < depth_m(pair.after));
    const SurfacePoint nearer = before_is_nearer ? moved(turn.inverse(), pair.before) : pair.after;
    const Pose camera = before_is_nearer ? camera_from_object * turn : camera_from_object;
    return seen_beside(views, camera, nearer, tolerance_m) ||
           seen_beside(views, camera_facing(nearer, tolerance_m), nearer, tolerance_m);
}

bool lie_together(const std::vector<Eigen::Vector3d>& points, double radius_m, int least_count) {
    return std::any_of(points.begin(), points.end(), [&](const Eigen::Vector3d& point) {
        return std::count_if(points.begin(), points.end(), [&](const Eigen::Vector3d& other) {
                   return (point - other).norm() < radius_m;
               }) >= least_count;
    });
}

// One Gauss-Newton step of turn <- exp(step about the centre) * turn on the planes of the surface before the turn, over
// pairs at most `gate_m` apart. Lengths are in units of `scale_m`, so that turns and shifts are damped alike.
Pose point_to_plane_step(const ViewsAround& around, const Pose& turn, double gate_m, double scale_m,
                         double min_normal_cosine) {
    constexpr int kStride = 2;
    const PixelGrid grid = every_ray(around.camera, kStride);
    const PinholeCamera camera = camera_of(grid, around.camera);
    const Eigen::Vector3d centre = around.views->extent().centre_in_object();
    Matrix6d A = Matrix6d::Zero();
    Twist b = Twist::Zero();
    for (std::size_t k = 0; k < around.cameras_from_object.size(); ++k) {
        const SeenPixels after = look(*around.views, around.cameras_from_object[k] * turn, camera);
        for (int i = 0; i < grid.size(); ++i) {
            const int pixel = grid.image_v(i) * around.camera.width + grid.image_u(i);
            const RayPair pair = pair_on(around.seen[k], pixel, after, i, turn);
            if (!pair.hit_before || !pair.hit_after) continue;
            const double residual_m = pair.before.normal.dot(pair.after.point - pair.before.point);
            if (std::abs(residual_m) > gate_m || pair.before.normal.dot(pair.after.normal) < min_normal_cosine)
                continue;
            Twist J;
            J << ((pair.after.point - centre) / scale_m).cross(pair.before.normal), pair.before.normal;
            A += J * J.transpose();
            b -= J * residual_m / scale_m;
        }
    }
    A += 1e-4 * (A.trace() + 1e-12) * Matrix6d::Identity();  // turns about the axis of a surface of revolution are free
    Twist step = A.ldlt().solve(b);
    step.tail<3>() *= scale_m;
    return perturb_about(Pose::identity(), step, centre) * turn;
}

}  // namespace

double ViewsAround::distance_m() const {
    return (cameras_from_object.front() * views->extent().centre_in_object()).z();
}

ViewsAround look_from_all_around(const ViewGenerator& views, int directions, int pixels_across) {
    ViewsAround around;
    around.views = &views;
    constexpr double kDistanceDiameters = 2.0;  // with that focal length the sphere around the box just fits in
    const double focal = 1.9 * pixels_across, middle = 0.5 * (pixels_across - 1);
    around.camera = {pixels_across, pixels_across, focal, focal, middle, middle};
    const ModelExtent& extent = views.extent();
    for (const Eigen::Vector3d& direction : directions_all_around(directions)) {
        around.cameras_from_object.push_back(camera_looking_along(direction, extent, kDistanceDiameters));
        around.seen.push_back(look(views, around.cameras_from_object.back(), around.camera));
        for (int pixel = 0; pixel < pixels_across * pixels_across; ++pixel)
            around.hits += around.seen.back().hit(pixel) ? 1 : 0;
    }
    return around;
}

SelfAgreement self_agreement(const ViewsAround& around, const Pose& turn, double tolerance_m, int stride,
                             double least_share) {
    const PixelGrid grid = every_ray(around.camera, stride);
    const PinholeCamera camera = camera_of(grid, around.camera);
    // How many rays may differ at most; the early end leaves a fifth more, since the number of rays is an estimate.
    const double most_differing = (1.0 - least_share) * around.hits / (stride * stride);
    SelfAgreement result;
    for (std::size_t k = 0; k < around.cameras_from_object.size(); ++k) {
        const SeenPixels after = look(*around.views, around.cameras_from_object[k] * turn, camera);
        for (int i = 0; i < grid.size(); ++i) {
            const int pixel = grid.image_v(i) * around.camera.width + grid.image_u(i);
            const RayPair pair = pair_on(around.seen[k], pixel, after, i, turn);
            if (!pair.hit_before && !pair.hit_after) continue;
            ++result.rays;
            const bool agrees = pair.hit_before && pair.hit_after && close(pair.before, pair.after, tolerance_m);
            result.differing += agrees ? 0 : 1;
        }
        if (result.differing > 1.2 * most_differing && result.share() < least_share) break;
    }
    return result;
}

Pose refined_turn(const ViewsAround& around, const Pose& turn, double tolerance_m,
                  const AxisRefinementOptions& options) {
    const double diameter_m = around.views->extent().diameter_m();
    Pose refined = turn;
    double gate_m = options.first_gate_diameters * diameter_m;
    for (int step = 0; step < options.steps; ++step) {
        refined = point_to_plane_step(around, refined, std::max(gate_m, 2.0 * tolerance_m), 0.5 * diameter_m,
                                      options.min_normal_cosine);
        gate_m *= options.gate_factor;
    }
    return refined;
}

bool shows_a_difference(const ViewsAround& around, const Pose& turn, double tolerance_m,
                        const DifferenceOptions& options) {
    const double pitch_m = around.distance_m() / around.camera.fx;
    std::vector<Eigen::Vector3d> differing_in_object;
    for (std::size_t k = 0; k < around.cameras_from_object.size(); ++k) {
        const Pose& camera_from_object = around.cameras_from_object[k];
        const SeenPixels after = look(*around.views, camera_from_object * turn, around.camera);
        for (int pixel = 0; pixel < around.camera.width * around.camera.height; ++pixel) {
            const RayPair pair = pair_on(around.seen[k], pixel, after, pixel, turn);
            if (!pair.hit_before && !pair.hit_after) continue;
            if (pair.hit_before && pair.hit_after && close(pair.before, pair.after, tolerance_m)) continue;
            if (has_counterpart_beside(*around.views, camera_from_object, turn, pair, tolerance_m)) continue;
            differing_in_object.push_back(pair.hit_before ? pair.before.point : pair.after.point);
        }
        if (static_cast<double>(differing_in_object.size()) > options.max_seam_share * around.hits) return true;
    }
    return lie_together(differing_in_object, 2.0 * pitch_m, options.detail_rays);
}

}  // namespace nearpose
