#include "raycast/internal/projected_samples.hpp"

#include <stdexcept>

namespace nearpose {

void check_view(const Pose& camera_from_object, const PinholeCamera& camera) {
    if (!is_valid(camera_from_object)) throw std::invalid_argument("view: the pose is not valid");
    validate(camera);
}

View view_of(const SurfaceSamples& samples, const std::vector<int>& sample_of_pixel, const Pose& camera_from_object) {
    const Eigen::Vector3f camera_in_object = camera_from_object.inverse().translation.cast<float>();
    View view;
    view.of_samples = true;
    for (std::size_t pixel = 0; pixel < sample_of_pixel.size(); ++pixel) {
        if (sample_of_pixel[pixel] < 0) continue;
        const auto sample = static_cast<std::size_t>(sample_of_pixel[pixel]);
        const Eigen::Vector3f& point = samples.points_in_object[sample];
        const Eigen::Vector3f& normal = samples.normals_in_object[sample];
        const bool faces_camera = normal.dot(camera_in_object - point) >= 0.0F;
        view.points_in_object.push_back(point);
        view.normals_in_object.emplace_back(faces_camera ? normal : Eigen::Vector3f(-normal));
        view.pixels.push_back(static_cast<int>(pixel));
    }
    return view;
}

}  // namespace nearpose
