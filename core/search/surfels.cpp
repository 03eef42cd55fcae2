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
    double area_m2 = 0.0;   // of the rectangle that has its points' moments: 12 sqrt(l1 l2) of their covariance
    int count = 0;

    bool holds(const Eigen::Vector3f& point, double tolerance_m) const {
        return std::abs(normal.dot(point.cast<double>()) - offset_m) < tolerance_m;
    }
};

// The plane of least squares through the points that `hypothesis` holds.
Plane refitted(const Plane& hypothesis, const std::vector<Eigen::Vector3f>& points, double tolerance_m) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
    Plane plane = hypothesis;
    plane.count = 0;
    for (const Eigen::Vector3f& point : points) {
        if (!hypothesis.holds(point, tolerance_m)) continue;
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

// The plane that holds most of the points, of `draws` through three of them each.
Plane dominant_plane(const std::vector<Eigen::Vector3f>& points, double tolerance_m, RandomStream& random) {
    constexpr int kDraws = 100;
    const int count = static_cast<int>(points.size());
    Plane best;
    for (int draw = 0; draw < kDraws && count >= 3; ++draw) {
        const Eigen::Vector3d a = points[random.below(count)].cast<double>();
        const Eigen::Vector3d b = points[random.below(count)].cast<double>();
        const Eigen::Vector3d c = points[random.below(count)].cast<double>();
        const Eigen::Vector3d across = (b - a).cross(c - a);
        if (!(across.norm() > 0.0)) continue;
        Plane plane;
        plane.normal = across.normalized();
        plane.offset_m = plane.normal.dot(a);
        for (const Eigen::Vector3f& point : points) plane.count += plane.holds(point, tolerance_m);
        if (plane.count > best.count) best = plane;
    }
    for (int round = 0; round < 2 && best.count >= 3; ++round) best = refitted(best, points, tolerance_m);
    return best;
}

std::vector<Eigen::Vector3f> points_of(const std::vector<OrientedPoint>& surface, std::size_t count) {
    std::vector<Eigen::Vector3f> points;
    const std::size_t every = std::max<std::size_t>(1, surface.size() / count);
    for (std::size_t k = 0; k < surface.size(); k += every) points.push_back(surface[k].point);
    return points;
}

// About 500 of the measured points that are in no plane yet.
std::vector<Eigen::Vector3f> points_left(const std::vector<Surfel>& surfels) {
    std::vector<Eigen::Vector3f> points, some;
    for (const Surfel& surfel : surfels)
        if (!surfel.in_plane && surfel.point_in_camera.z() > 0.0F) points.push_back(surfel.point_in_camera);
    const std::size_t every = std::max<std::size_t>(1, points.size() / 500);
    for (std::size_t p = 0; p < points.size(); p += every) some.push_back(points[p]);
    return some;
}

// Finds the large planes. One that is larger than any face of the model is none of its faces: what lies in it says
// little. Of one that may be a face, a start is not to be made from it alone: each counts as a small part of the view.
void set_rarity(std::vector<Surfel>& surfels, double largest_face_m2, double tolerance_m, RandomStream random) {
    constexpr int kPlanes = 3;
    constexpr double kLeastShare = 0.1;  // of the points
    for (int k = 0; k < kPlanes; ++k) {
        const std::vector<Eigen::Vector3f> points = points_left(surfels);
        const Plane plane = dominant_plane(points, tolerance_m, random);
        const double share_of_view = plane.count / std::max(1.0, static_cast<double>(points.size()));
        if (share_of_view < kLeastShare) return;
        const double size = largest_face_m2 / std::max(1e-12, plane.area_m2);
        const double weight = size < 1.0 ? size * size * size : 1.0;
        for (Surfel& surfel : surfels) {
            if (surfel.in_plane || !plane.holds(surfel.point_in_camera, tolerance_m)) continue;
            surfel.in_plane = true;
            surfel.weight = weight;
            surfel.balanced_draw_weight = std::min(weight, kLeastShare / share_of_view);
            surfel.draw_weight = std::min(surfel.draw_weight, weight);
        }
    }
}

// The measured surface around a pixel: the plane of least squares through a window of pixels `reach` to each side, of
// those that lie on one surface with the middle one. Holes and edges cost samples, not the normal.
std::optional<OrientedPoint> measured_at(const Observation& observation, int pixel, int reach) {
    constexpr int kHalf = 2, kLeastSamples = 9;
    const PinholeCamera& camera = observation.camera();
    if (observation.states()[pixel] != PixelState::kCandidate) return std::nullopt;
    const Eigen::Vector3f middle = observation.point_at(pixel).cast<float>();
    const double step_m = middle.z() / camera.fx;  // a pixel's width there
    std::vector<Eigen::Vector3f> window;
    for (int j = -kHalf; j <= kHalf; ++j) {
        for (int i = -kHalf; i <= kHalf; ++i) {
            const int u = pixel % camera.width + i * reach / kHalf, v = pixel / camera.width + j * reach / kHalf;
            if (u < 0 || v < 0 || u >= camera.width || v >= camera.height) continue;
            const int other = v * camera.width + u;
            if (observation.states()[other] != PixelState::kCandidate) continue;
            const Eigen::Vector3f point = observation.point_at(other).cast<float>();
            if (std::abs(point.z() - middle.z()) < 2.0 * reach * step_m) window.push_back(point);
        }
    }
    if (window.size() < kLeastSamples) return std::nullopt;
    Plane plane = refitted(Plane{Eigen::Vector3d::UnitZ(), 0.0, 0.0, 0}, window, 1e9);
    const double tolerance_m = 3.0 * observation.sigma_m(middle.z()) + 0.1 * reach * step_m;
    for (int round = 0; round < 2; ++round) plane = refitted(plane, window, tolerance_m);
    if (plane.count < kLeastSamples || !plane.holds(middle, tolerance_m)) return std::nullopt;
    Eigen::Vector3f normal = plane.normal.cast<float>();
    if (normal.dot(middle) > 0.0F) normal = -normal;
    return OrientedPoint{middle, normal};
}

}  // namespace

// Area of the largest flat face among the points.
double largest_face(const std::vector<OrientedPoint>& surface, double tolerance_m) {
    const std::vector<Eigen::Vector3f> points = points_of(surface, 600);
    double largest_m2 = 0.0;
    for (std::size_t k = 0; k < std::min<std::size_t>(surface.size(), 400); ++k) {
        Plane plane;
        plane.normal = surface[k].normal.cast<double>();
        plane.offset_m = plane.normal.dot(surface[k].point.cast<double>());
        largest_m2 = std::max(largest_m2, refitted(plane, points, tolerance_m).area_m2);
    }
    return largest_m2;
}

SurfelGrid make_surfels(const Observation& observation, int reach, double tolerance_m, double largest_face_m2,
                        RandomStream random) {
    constexpr double kSurfels = 4000.0;
    const PinholeCamera& camera = observation.camera();
    SurfelGrid grid;
    const PixelBox& box = observation.candidate_box();
    const double pixels = static_cast<double>(box.last_u - box.first_u) * (box.last_v - box.first_v);
    grid.stride = std::max(1, static_cast<int>(std::sqrt(pixels / kSurfels)));
    grid.width = camera.width / grid.stride;
    grid.height = camera.height / grid.stride;
    for (int v = 0; v < grid.height; ++v) {
        for (int u = 0; u < grid.width; ++u) {
            const int middle = grid.stride / 2;
            const int pixel = (v * grid.stride + middle) * camera.width + u * grid.stride + middle;
            const std::optional<OrientedPoint> measured = measured_at(observation, pixel, reach);
            Surfel surfel;
            if (observation.states()[pixel] == PixelState::kCandidate)
                surfel.point_in_camera = observation.point_at(pixel).cast<float>();
            surfel.surface = measured.value_or(OrientedPoint{{0, 0, 0}, {0, 0, 0}});
            surfel.draw_weight = measured ? 1.0 : 0.0;
            grid.surfels.push_back(surfel);
        }
    }
    set_rarity(grid.surfels, largest_face_m2, tolerance_m, random);
    return grid;
}

}  // namespace nearpose
