#include "apps/compare/view_cell.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "apps/compare/line_of_sight.hpp"
#include "core/check.hpp"
#include "raycast/embree_view_generator.hpp"
#include "raycast/raster_view_generator.hpp"
#include "raycast/sphere_view_generator.hpp"

namespace nearpose::compare {
namespace {

// Of all triangles, or of all discs of a cloud.
double area_of(const Mesh& mesh) {
    if (mesh.is_cloud()) {
        const double disc_m2 = std::numbers::pi * static_cast<double>(mesh.disc_radius_m * mesh.disc_radius_m);
        return disc_m2 * static_cast<double>(mesh.vertices_in_object.size());
    }
    double doubled = 0.0;
    for (const auto& triangle : mesh.triangles) {
        const auto corner = [&](int k) -> Eigen::Vector3d {
            return mesh.vertices_in_object[static_cast<std::size_t>(triangle[static_cast<std::size_t>(k)])]
                .cast<double>();
        };
        doubled += (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm();
    }
    return 0.5 * doubled;
}

}  // namespace

void validate(const ViewCell& cell) {
    if (cell.views != "raycast" && cell.views != "raster" && cell.views != "sphere") {
        throw std::invalid_argument("views '" + cell.views + "': take raycast, raster or sphere");
    }
    check_option("view_samples", cell.view_samples, 1, 1e7);
    check_option("distance_mm", cell.distance_mm, 1.0, 1e5);
    check_option("max_rays", cell.max_rays, 1, 1e7);
    check_option("viewpoints", cell.viewpoints, 1, 1e5);
    check_option("sphere_radius_diameters", cell.sphere_radius_diameters, 0.51, 100.0);
    check_option("timed_views", cell.timed_views, 0, 1e6);
}

ViewBench::ViewBench(const Mesh& mesh, const simulate::Part& part, const PinholeCamera& image_camera)
    : mesh_(clean(mesh, "mesh")), part_(part), image_camera_(image_camera), truth_(mesh_), area_m2_(area_of(mesh_)) {}

int ViewBench::sphere_image_size(const ViewCell& cell) const {
    // A pixel of a stored image, on a surface at the object's centre that faces the camera, has the side
    // 2 * slope * radius / size; slope is the tangent of half the angle under which the whole object is seen.
    const double radius_m = cell.sphere_radius_diameters * truth_.extent().diameter_m();
    const double sine = 0.5 / cell.sphere_radius_diameters;
    const double slope = sine / std::sqrt(1.0 - sine * sine);
    const double pixel_m = std::sqrt(area_m2_ / cell.view_samples);
    return std::clamp(static_cast<int>(std::lround(2.0 * slope * radius_m / pixel_m)), 2, 1024);
}

std::shared_ptr<const ViewGenerator> ViewBench::generator(const ViewCell& cell) const {
    Key key{cell.views, 0, 0, 0.0};
    if (cell.views == "raster") key = {cell.views, cell.view_samples, 0, 0.0};
    if (cell.views == "sphere") {
        key = {cell.views, sphere_image_size(cell), cell.viewpoints, cell.sphere_radius_diameters};
    }
    const std::lock_guard lock(mutex_);
    auto& slot = generators_[key];
    if (slot) return slot;
    if (cell.views == "raster") {
        slot = std::make_shared<RasterViewGenerator>(mesh_, RasterOptions{cell.view_samples, 1});
    } else if (cell.views == "sphere") {
        const SphereOptions options{cell.viewpoints, cell.sphere_radius_diameters, sphere_image_size(cell)};
        slot = std::make_shared<SphereViewGenerator>(mesh_, options);
    } else {
        slot = std::make_shared<EmbreeViewGenerator>(mesh_);
    }
    return slot;
}

ViewQuality ViewBench::quality(const ViewCell& cell) const {
    validate(cell);
    const Pose pose = pose_at(draw_line_of_sight(truth_, part_, cell.seed), 1e-3 * cell.distance_mm);
    const ViewTask task{image_camera_, cell.max_rays, cell.timed_views};
    return view_quality(*generator(cell), truth_, task, {&pose, 1});
}

std::vector<NamedNumber> ViewBench::numbers(const ViewCell& cell) const {
    const ViewQuality quality = this->quality(cell);
    if (quality.views == 0) return {};
    std::vector<NamedNumber> numbers = {
        {"points_per_view", quality.points_per_view},       {"pixels_per_view", quality.pixels_per_view},
        {"wrong_percent", 100.0 * quality.wrong_share},     {"hidden_percent", 100.0 * quality.hidden_share},
        {"missing_percent", 100.0 * quality.missing_share}, {"mean_distance_mm", 1e3 * quality.mean_distance_m},
        {"distance_95_mm", 1e3 * quality.distance_95_m},    {"max_distance_mm", 1e3 * quality.max_distance_m}};
    if (cell.timed_views > 0) {
        numbers.push_back({"cpu_ms_per_200_views", 1e3 * quality.cpu_s_per_200});
        numbers.push_back({"raycast_cpu_ms_per_200_views", 1e3 * quality.raycast_cpu_s_per_200});
        numbers.push_back({"cpu_ratio_to_raycast", quality.cpu_s_per_200 / quality.raycast_cpu_s_per_200});
    }
    return numbers;
}

}  // namespace nearpose::compare
