#include "raycast/internal/exact_surface.hpp"

#include <cmath>
#include <stdexcept>
#include <utility>

namespace nearpose {
namespace {

// Steeper rays and farther cameras are refused; Embree stops the process for numbers above 1e18.
constexpr double kMaxRaySlope = 1e6;

}  // namespace

void require_castable(const Pose& camera_from_object, const PinholeCamera& camera) {
    if (!is_valid(camera_from_object)) {
        throw std::invalid_argument(
            "cast: the pose is not valid (a number is not finite, the quaternion not of unit "
            "length, or the translation beyond 1e6 m)");
    }
    validate(camera);
    for (const Eigen::Vector3d& ray : {camera.ray(0, 0), camera.ray(camera.width, camera.height)}) {
        if (!(ray.cwiseAbs().maxCoeff() < kMaxRaySlope)) {
            throw std::invalid_argument("cast: rays of this camera are steeper than 1e6: check fx, fy, cx, cy");
        }
    }
}

ExactSurface::ExactSurface(Mesh mesh) : mesh_(std::move(mesh)) {
    for (const Eigen::Vector3f& normal : mesh_.vertex_normals_in_object)
        if (mesh_.is_cloud()) plane_normals_.push_back(normal.cast<double>());
    for (const auto& triangle : mesh_.triangles) {
        const auto vertex = [&](int k) {
            return Eigen::Vector3d(mesh_.vertices_in_object[static_cast<std::size_t>(triangle[k])].cast<double>());
        };
        plane_normals_.push_back((vertex(1) - vertex(0)).cross(vertex(2) - vertex(0)));
    }
    for (const Eigen::Vector3d& normal : plane_normals_) unit_normals_.push_back(normal.normalized().cast<float>());
}

Eigen::Vector3d ExactSurface::point_on(int primitive) const {
    const auto index = static_cast<std::size_t>(primitive);
    const std::size_t vertex = mesh_.is_cloud() ? index : static_cast<std::size_t>(mesh_.triangles[index][0]);
    return mesh_.vertices_in_object[vertex].cast<double>();
}

// Embree's depth is a float whose last bits depend on the instruction set. The depth of the plane that was hit is
// computed again in double; where it does not agree (a ray within the plane) Embree's stays.
void ExactSurface::append(const RayBundle& bundle, int u, int v, const PrimitiveHit& hit, RayHits& hits) const {
    const Eigen::Vector3d direction = bundle.direction(u, v);
    const bool faces_ray = plane_normals_.empty();
    const Eigen::Vector3d normal = faces_ray ? Eigen::Vector3d(-direction) : plane_normals_[hit.primitive];
    const double slope = normal.dot(direction);
    const double plane_depth = normal.dot(point_on(hit.primitive) - bundle.origin_in_object) / slope;
    const bool agrees = std::abs(plane_depth - hit.depth) <= 1e-4 * hit.depth;  // false for NaN
    const double depth = agrees ? plane_depth : static_cast<double>(hit.depth);
    if (!std::isfinite(depth) || !(depth > 0.0)) return;

    hits.pixels.push_back(v * bundle.camera.width + u);
    hits.points_in_object.emplace_back((bundle.origin_in_object + depth * direction).cast<float>());
    const Eigen::Vector3f unit =
        faces_ray ? Eigen::Vector3f(normal.normalized().cast<float>()) : unit_normals_[hit.primitive];
    hits.normals_in_object.emplace_back(slope > 0.0 ? Eigen::Vector3f(-unit) : unit);
    hits.depth_m.push_back(static_cast<float>(depth));
}

}  // namespace nearpose
