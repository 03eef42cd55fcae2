#include "raycast/point_splat.hpp"

#include "raycast/internal/projected_samples.hpp"

namespace nearpose {

View nearest_points(const SurfaceSamples& samples, const Pose& camera_from_object, const PinholeCamera& camera) {
    check_view(camera_from_object, camera);
    NearestSamples pixels(camera);
    project_samples(samples, camera_from_object, camera, 0.0, [&pixels](const ProjectedSample& sample) {
        pixels.draw(sample.pixel, sample.point_in_camera.z(), sample.sample);
    });
    return view_of(samples, pixels.kept, camera_from_object);
}

}  // namespace nearpose
