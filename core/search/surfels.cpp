#include "core/search/surfels.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>

namespace nearpose {
namespace {

struct Plane {
    Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
    double offset_m = 0.0;  // normal . point
    double area_m2 = 0.0;   // of the rectangle with its points' second moments: 12 sqrt(l1 l2) of their covariance
    int count = 0;

    bool contains(const Eigen::Vector3f& point, double tolerance_m) const {
        return std::abs(normal.dot(point.cast<double>()) - offset_m) < tolerance_m;
    }
};

// The plane of least squares through the points that `hypothesis` contains.
Plane least_squares_plane(const Plane& hypothesis, const std::vector<Eigen::Vector3f>& points, double tolerance_m) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
    Plane plane = hypothesis;
    plane.count = 0;
    for (const Eigen::Vector3f& point : points) {
        if (!hypothesis.contains(point, tolerance_m)) continue;
        const Eigen::Vector3d p = point.cast<double>();
        sum += p;
        squares += p * p.transpose();
        ++plane.count;
    }
    if (plane.count < 3) return plane;
    const Eigen::Vector3d mean = sum / plane.count;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(squares / plane.count - mean * mean.transpose());
    plane.normal = solver.eigenvectors().col(0);
    plane.offset_m = plane.normal.dot(mean);
    plane.area_m2 = 12.0 * std::sqrt(std::max(0.0, solver.eigenvalues()[1] * solver.eigenvalues()[2]));
    return plane;
}

// The plane that contains most of the points, by sample consensus (Fischler and Bolles 1981).
Plane dominant_plane(const std::vector<Eigen::Vector3f>& points, double tolerance_m, RandomStream& random,
                     const SurfelOptions& options) {
    const int count = static_cast<int>(points.size());
    Plane best;
    for (int draw = 0; draw < options.plane_draws && count >= 3; ++draw) {
        const Eigen::Vector3d a = points[random.below(count)].cast<double>();
        const Eigen::Vector3d b = points[random.below(count)].cast<double>();
        const Eigen::Vector3d c = points[random.below(count)].cast<double>();
        const Eigen::Vector3d across = (b - a).cross(c - a);
        if (!(across.norm() > 0.0)) continue;
        Plane plane;
        plane.normal = across.normalized();
        plane.offset_m = plane.normal.dot(a);
        for (const Eigen::Vector3f& point : points) plane.count += plane.contains(point, tolerance_m);
        if (plane.count > best.count) best = plane;
    }
    for (int fit = 0; fit < options.plane_fits && best.count >= 3; ++fit)
        best = least_squares_plane(best, points, tolerance_m);
    return best;
}

// About `count` of the points, or all of fewer.
std::vector<Eigen::Vector3f> thinned(const std::vector<Eigen::Vector3f>& points, int count) {
    std::vector<Eigen::Vector3f> some;
    const std::size_t every = std::max<std::size_t>(1, points.size() / static_cast<std::size_t>(count));
    for (std::size_t k = 0; k < points.size(); k += every) some.push_back(points[k]);
    return some;
}

std::vector<Eigen::Vector3f> points_in_no_plane(const std::vector<Surfel>& surfels) {
    std::vector<Eigen::Vector3f> points;
    for (const Surfel& surfel : surfels)
        if (!surfel.in_plane && surfel.point_in_camera.z() > 0.0F) points.push_back(surfel.point_in_camera);
    return points;
}

// Finds the large planes and sets the weights of what lies in them. A plane larger than any face of the model is none
// of its faces, and agreement with it says little. Of a plane that may be a face, the balanced weight lets it count as
// a small part of the view.
void weigh_large_planes(std::vector<Surfel>& surfels, double largest_face_m2, double tolerance_m, RandomStream random,
                        const SurfelOptions& options) {
    for (int k = 0; k < options.planes; ++k) {
        const std::vector<Eigen::Vector3f> points = thinned(points_in_no_plane(surfels), options.plane_points);
        const Plane plane = dominant_plane(points, tolerance_m, random, options);
        const double share_of_view = plane.count / std::max(1.0, static_cast<double>(points.size()));
        if (share_of_view < options.min_plane_share) return;
        const double size_ratio = largest_face_m2 / std::max(1e-12, plane.area_m2);
        const double weight = size_ratio < 1.0 ? size_ratio * size_ratio * size_ratio : 1.0;
        for (Surfel& surfel : surfels) {
            if (surfel.in_plane || !plane.contains(surfel.point_in_camera, tolerance_m)) continue;
            surfel.in_plane = true;
            surfel.evidence_weight = weight;
            surfel.balanced_draw_weight = std::min(weight, options.min_plane_share / share_of_view);
            surfel.draw_weight = std::min(surfel.draw_weight, weight);
        }
    }
}

// Samples of the measured surface in a window of `reach_pixels` to each side, of those that lie on one surface with the
// middle one. Spread samples keep the cost small where the window is large.
std::vector<Eigen::Vector3f> window_around(const Observation& observation, int pixel, const Eigen::Vector3f& middle,
                                           int reach_pixels, const SurfelOptions& options) {
    const PinholeCamera& camera = observation.camera();
    const double pixel_width_m = middle.z() / camera.fx;  // at that distance
    const int half = options.window_half;
    std::vector<Eigen::Vector3f> window;
    for (int j = -half; j <= half; ++j) {
        for (int i = -half; i <= half; ++i) {
            const int u = pixel % camera.width + i * reach_pixels / half;
            const int v = pixel / camera.width + j * reach_pixels / half;
            if (u < 0 || v < 0 || u >= camera.width || v >= camera.height) continue;
            const int other = v * camera.width + u;
            if (observation.states()[other] != PixelState::kCandidate) continue;
            const Eigen::Vector3f point = observation.point_at(other).cast<float>();
            if (std::abs(point.z() - middle.z()) < options.window_depth_reaches * reach_pixels * pixel_width_m)
                window.push_back(point);
        }
    }
    return window;
}

// The measured surface at a pixel: the plane of least squares through the window around it. Holes and edges cost
// samples, not the normal. None where too few samples lie in one plane, or the pixel itself does not.
std::optional<OrientedPoint> measured_at(const Observation& observation, int pixel, int reach_pixels,
                                         const SurfelOptions& options) {
    constexpr double kAll_m = 1e9;
    if (observation.states()[pixel] != PixelState::kCandidate) return std::nullopt;
    const Eigen::Vector3f middle = observation.point_at(pixel).cast<float>();
    const auto window = window_around(observation, pixel, middle, reach_pixels, options);
    if (static_cast<int>(window.size()) < options.min_samples) return std::nullopt;
    Plane plane = least_squares_plane(Plane{Eigen::Vector3d::UnitZ(), 0.0, 0.0, 0}, window, kAll_m);
    const double pixel_width_m = middle.z() / observation.camera().fx;
    const double tolerance_m =
        options.plane_sigmas * observation.sigma_m(middle.z()) + options.plane_reaches * reach_pixels * pixel_width_m;
    for (int fit = 0; fit < options.normal_fits; ++fit) plane = least_squares_plane(plane, window, tolerance_m);
    if (plane.count < options.min_samples || !plane.contains(middle, tolerance_m)) return std::nullopt;
    Eigen::Vector3f normal = plane.normal.cast<float>();
    if (normal.dot(middle) > 0.0F) normal = -normal;  // towards the camera
    return OrientedPoint{middle, normal};
}

}  // namespace

double largest_face(const std::vector<OrientedPoint>& surface, double tolerance_m, const LargestFaceOptions& options) {
    std::vector<Eigen::Vector3f> all;
    for (const OrientedPoint& oriented : surface) all.push_back(oriented.point);
    const std::vector<Eigen::Vector3f> points = thinned(all, options.points);
    double largest_m2 = 0.0;
    for (std::size_t k = 0; k < std::min(surface.size(), static_cast<std::size_t>(options.planes)); ++k) {
        Plane plane;
        plane.normal = surface[k].normal.cast<double>();
        plane.offset_m = plane.normal.dot(surface[k].point.cast<double>());
        largest_m2 = std::max(largest_m2, least_squares_plane(plane, points, tolerance_m).area_m2);
    }
    return largest_m2;
}

SurfelGrid make_surfels(const Observation& observation, int reach_pixels, double tolerance_m, double largest_face_m2,
                        RandomStream random, const SurfelOptions& options) {
    const PinholeCamera& camera = observation.camera();
    SurfelGrid grid;
    const PixelBox& box = observation.candidate_box();
    const double pixels = static_cast<double>(box.last_u - box.first_u) * (box.last_v - box.first_v);
    grid.stride = std::max(1, static_cast<int>(std::sqrt(pixels / options.count)));
    grid.width = camera.width / grid.stride;
    grid.height = camera.height / grid.stride;
    for (int v = 0; v < grid.height; ++v) {
        for (int u = 0; u < grid.width; ++u) {
            const int middle = grid.stride / 2;
            const int pixel = (v * grid.stride + middle) * camera.width + u * grid.stride + middle;
            const std::optional<OrientedPoint> measured = measured_at(observation, pixel, reach_pixels, options);
            Surfel surfel;
            if (observation.states()[pixel] == PixelState::kCandidate)
                surfel.point_in_camera = observation.point_at(pixel).cast<float>();
            surfel.surface = measured.value_or(OrientedPoint{{0, 0, 0}, {0, 0, 0}});
            surfel.draw_weight = measured ? 1.0 : 0.0;
            grid.surfels.push_back(surfel);
        }
    }
    weigh_large_planes(grid.surfels, largest_face_m2, tolerance_m, random, options);
    return grid;
}

std::vector<OrientedPoint> systematic_sample(const SurfelGrid& grid, std::size_t count) {
    constexpr std::size_t kStride = 149;  // prime to most numbers of points, so that all are taken
    const auto weight_of = [](const Surfel& surfel) {
        return surfel.draw_weight > 0.0 ? surfel.balanced_draw_weight : 0.0;
    };
    double sum = 0.0;
    for (const Surfel& surfel : grid.surfels) sum += weight_of(surfel);
    const double step = sum / static_cast<double>(count);
    std::vector<OrientedPoint> in_rows, points;
    double reached = 0.0, mark = 0.5 * step;
    for (const Surfel& surfel : grid.surfels) {
        reached += weight_of(surfel);
        for (; mark < reached && in_rows.size() < count; mark += step) in_rows.push_back(surfel.surface);
    }
    for (std::size_t k = 0; k < in_rows.size(); ++k) points.push_back(in_rows[k * kStride % in_rows.size()]);
    return points;
}

}  // namespace nearpose
