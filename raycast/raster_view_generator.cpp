#include "raycast/raster_view_generator.hpp"

#include "raycast/point_splat.hpp"

namespace nearpose {

RasterViewGenerator::RasterViewGenerator(const Mesh& mesh, const RasterOptions& options) {
    const Mesh usable = clean(mesh, "mesh");
    samples_ = sample_surface(usable, options.num_samples, options.seed);
    extent_ = extent_of(usable);
}

View RasterViewGenerator::generate(const Pose& camera_from_object, const PinholeCamera& camera) const {
    return nearest_points(samples_, camera_from_object, camera);
}

}  // namespace nearpose
