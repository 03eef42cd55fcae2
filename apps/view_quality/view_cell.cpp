#include "apps/view_quality/view_cell.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "apps/runs/estimator_setup.hpp"
#include "apps/scenes/surface_points.hpp"
#include "core/base/check.hpp"
#include "raycast/embree_view_generator.hpp"
#include "raycast/nested_spheres_generator.hpp"
#include "raycast/raster_view_generator.hpp"
#include "raycast/sphere_view_generator.hpp"

namespace nearpose::compare {

void validate(const ViewCell& cell) {
    if (std::find(program::view_names().begin(), program::view_names().end(), cell.views) ==
        program::view_names().end()) {
        throw std::invalid_argument("views '" + cell.views +
                                    "': take raycast, raster, raster_cells, raster_as_rays, sphere or spheres");
    }
    check_option("view_samples", cell.view_samples, 1, 1e7);
    check_option("distance_mm", cell.distance_mm, 10.0, 1e5);
    check_option("max_rays", cell.max_rays, 1, 1e7);
    check_option("viewpoints", cell.viewpoints, 1, 1e5);
    check_option("sphere_radius_diameters", cell.sphere_radius_diameters, 0.51, 100.0);
    check_option("timed_views", cell.timed_views, 0, 1e6);
}

ViewBench::ViewBench(const Mesh& mesh, const simulate::Part& part, const PinholeCamera& image_camera)
    : mesh_(clean(mesh, "mesh")),
      part_(part),
      image_camera_(image_camera),
      truth_(mesh_),
      area_m2_(surface_area_m2(mesh_)) {
    // As recordings of the sweep scenario do, so that seeds mean the same lines of sight.
    if (part_.surface_points_in_object_m.empty()) {
        part_.surface_points_in_object_m = simulate::surface_points_from_above(mesh_);
    }
}

int ViewBench::sphere_image_size(int view_samples, double radius_diameters) const {
    // A pixel of a stored image, on a surface at the object's centre that faces the camera, has the side
    // 2 * slope * radius / size; slope is the tangent of half the angle under which the whole object is seen.
    const double radius_m = radius_diameters * truth_.extent().diameter_m();
    const double sine = 0.5 / radius_diameters;
    const double slope = sine / std::sqrt(1.0 - sine * sine);
    const double pixel_m = std::sqrt(area_m2_ / view_samples);
    return std::clamp(static_cast<int>(std::lround(2.0 * slope * radius_m / pixel_m)), 2, 1024);
}

std::shared_ptr<const ViewGenerator> ViewBench::make_generator(const ViewCell& cell) const {
    const auto sphere = [&](double radius) {
        return SphereOptions{cell.viewpoints, radius, sphere_image_size(cell.view_samples, radius)};
    };
    if (program::is_rasteriser(cell.views)) {
        return std::make_shared<RasterViewGenerator>(
            mesh_, RasterOptions{cell.view_samples, 1, program::raster_buffer(cell.views)});
    }
    if (cell.views == "sphere") {
        return std::make_shared<SphereViewGenerator>(mesh_, sphere(cell.sphere_radius_diameters));
    }
    if (cell.views == "spheres") {
        std::vector<SphereOptions> spheres;
        for (const double radius : kNestedRadii_diameters) spheres.push_back(sphere(radius));
        return std::make_shared<NestedSpheresGenerator>(mesh_, spheres);
    }
    return std::make_shared<EmbreeViewGenerator>(mesh_);
}

std::shared_ptr<const ViewGenerator> ViewBench::generator(const ViewCell& cell) const {
    validate(cell);
    Key key{cell.views, 0, 0, 0.0};
    if (cell.views != "raycast") std::get<1>(key) = cell.view_samples;
    if (cell.views == "sphere" || cell.views == "spheres") std::get<2>(key) = cell.viewpoints;
    if (cell.views == "sphere") std::get<3>(key) = cell.sphere_radius_diameters;
    const std::lock_guard lock(mutex_);  // a second thread waits rather than builds the same
    auto& slot = generators_[key];
    if (!slot) slot = make_generator(cell);
    return slot;
}

ViewQuality ViewBench::quality(const ViewCell& cell) const {
    validate(cell);
    simulate::ScenarioOptions at_distance;
    at_distance.far_m = at_distance.near_m = 1e-3 * cell.distance_mm;
    const Pose pose = simulate::task_path(simulate::Scenario::kSweep, part_, image_camera_, 1, cell.seed, at_distance)
                          .camera_from_object.front();
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
