#include "apps/scenes/surface_points.hpp"

#include <algorithm>

#include "raycast/embree_scene.hpp"

namespace nearpose::simulate {

std::vector<Eigen::Vector3d> surface_points_from_above(const Mesh& mesh) {
    constexpr int kSide = 33;          // rays along each side of the box
    constexpr double kTop = 0.15;      // of the part's height that counts as near the top
    constexpr double kUpright = 0.94;  // cosine of 20 degrees
    constexpr double kInside = 0.8;    // of the box's sides: at its rim there is little to see
    constexpr double kAway = 1000.0;   // of the camera, in box sizes: rays are as good as parallel
    const EmbreeScene scene(mesh);
    const ModelExtent& extent = scene.extent();
    const Eigen::Vector3d centre = extent.centre_in_object();
    const Eigen::Vector3d size = extent.box_max_in_object - extent.box_min_in_object;
    const double away_m = kAway * extent.diameter_m();
    Pose object_from_camera;
    object_from_camera.rotation = Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0);  // looks down
    object_from_camera.translation = {centre.x(), centre.y(), extent.box_max_in_object.z() + away_m};
    const double middle = 0.5 * (kSide - 1);
    const double focal_u = away_m * (kSide - 1) / std::max(1e-9, kInside * size.x());
    const double focal_v = away_m * (kSide - 1) / std::max(1e-9, kInside * size.y());
    const RayHits hits = scene.cast(object_from_camera.inverse(), {kSide, kSide, focal_u, focal_v, middle, middle});
    float top = -1e30F;
    for (const Eigen::Vector3f& point : hits.points_in_object) top = std::max(top, point.z());
    std::vector<Eigen::Vector3d> points;
    for (std::size_t i = 0; i < hits.size(); ++i) {
        const Eigen::Vector3d point = hits.points_in_object[i].cast<double>();
        if (point.z() >= top - kTop * size.z() && hits.normals_in_object[i].z() >= kUpright) points.push_back(point);
    }
    // A part without any level surface: the highest point that is hit, or the top of the box.
    if (points.empty()) {
        for (const Eigen::Vector3f& point : hits.points_in_object) {
            if (point.z() == top) points.push_back(point.cast<double>());
        }
    }
    if (points.empty()) points.emplace_back(centre.x(), centre.y(), extent.box_max_in_object.z());
    return points;
}

}  // namespace nearpose::simulate
