#include "raycast/raster_view_generator.hpp"

#include "core/base/check.hpp"
#include "raycast/fitted_buffer.hpp"
#include "raycast/point_splat.hpp"

namespace nearpose {

RasterViewGenerator::RasterViewGenerator(const Mesh& mesh, const RasterOptions& options) : buffer_(options.buffer) {
    check_option("coverage (of the rasteriser)", options.coverage, 0.1, 1000.0);
    const Mesh usable = clean(mesh, "mesh");
    samples_ = sample_surface(usable, options.num_samples, options.seed);
    extent_ = extent_of(usable);
    // A cloud may have fewer points than samples were asked for.
    cell_area_m2_ = options.coverage * surface_area_m2(usable) / static_cast<double>(samples_.points_in_object.size());
}

View RasterViewGenerator::generate(const Pose& camera_from_object, const PinholeCamera& camera) const {
    if (buffer_ == RasterBuffer::kAsRays) return nearest_points(samples_, camera_from_object, camera);
    if (buffer_ == RasterBuffer::kCells) {
        return nearest_of_cells(samples_, cell_area_m2_, camera_from_object, camera);
    }
    return points_before_splats(samples_, cell_area_m2_, camera_from_object, camera);
}

}  // namespace nearpose
