#include "tests/bench/naive/single_ray_views.hpp"

#include <Eigen/Geometry>
#include <limits>

namespace nearpose::bench::naive {

SeenSurface SingleRayViews::generate(const Pose& camera_from_object, const PinholeCamera& camera) const {
    const Pose object_from_camera = camera_from_object.inverse();
    const Eigen::Matrix3d rotation = object_from_camera.rotation_matrix();
    const Eigen::Vector3f origin = object_from_camera.translation.cast<float>();
    SeenSurface seen;
    for (int v = 0; v < camera.height; ++v) {
        for (int u = 0; u < camera.width; ++u) {
            const Eigen::Vector3f direction = (rotation * camera.ray(u, v)).cast<float>();
            RTCRayHit ray{};
            ray.ray.org_x = origin.x(), ray.ray.org_y = origin.y(), ray.ray.org_z = origin.z();
            ray.ray.dir_x = direction.x(), ray.ray.dir_y = direction.y(), ray.ray.dir_z = direction.z();
            ray.ray.tfar = std::numeric_limits<float>::infinity();
            ray.ray.mask = ~0U;
            ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
            scene_.intersect(ray);
            if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) continue;
            const Eigen::Vector3f normal = Eigen::Vector3f(ray.hit.Ng_x, ray.hit.Ng_y, ray.hit.Ng_z).normalized();
            seen.points_in_object.push_back(origin + ray.ray.tfar * direction);
            seen.normals_in_object.push_back(normal.dot(direction) > 0.0F ? Eigen::Vector3f(-normal) : normal);
        }
    }
    return seen;
}

PinholeCamera quarter_camera(const PinholeCamera& camera) {
    constexpr int kStride = 4;
    return camera_of({0, 0, kStride, camera.width / kStride, camera.height / kStride}, camera);
}

}  // namespace nearpose::bench::naive
