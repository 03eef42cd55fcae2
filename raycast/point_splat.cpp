#include "raycast/point_splat.hpp"

#include <limits>
#include <stdexcept>
#include <vector>

namespace nearpose {

View nearest_points(const SurfaceSamples& samples, const Pose& camera_from_object, const PinholeCamera& camera) {
    if (!is_valid(camera_from_object)) throw std::invalid_argument("view: the pose is not valid");
    validate(camera);
    const Eigen::Matrix3d rotation = camera_from_object.rotation_matrix();
    const std::size_t num_pixels = static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
    std::vector<double> depth(num_pixels, std::numeric_limits<double>::infinity());  // [m]
    std::vector<int> nearest(num_pixels, -1);
    for (std::size_t i = 0; i < samples.points_in_object.size(); ++i) {
        const Eigen::Vector3d point_in_camera =
            rotation * samples.points_in_object[i].cast<double>() + camera_from_object.translation;
        if (!(point_in_camera.z() > 0.0)) continue;
        const Eigen::Vector2d uv = camera.project(point_in_camera);
        const int pixel = camera.pixel_at(uv.x(), uv.y());
        if (pixel < 0 || !(point_in_camera.z() < depth[static_cast<std::size_t>(pixel)])) continue;
        depth[static_cast<std::size_t>(pixel)] = point_in_camera.z();
        nearest[static_cast<std::size_t>(pixel)] = static_cast<int>(i);
    }

    const Eigen::Vector3f camera_in_object = camera_from_object.inverse().translation.cast<float>();
    View view;
    view.of_samples = true;
    for (std::size_t pixel = 0; pixel < num_pixels; ++pixel) {
        if (nearest[pixel] < 0) continue;
        const auto sample = static_cast<std::size_t>(nearest[pixel]);
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
