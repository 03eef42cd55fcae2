#include <algorithm>
#include <cmath>

#include "apps/base/simulation_draws.hpp"
#include "apps/data_set/bop_writer.hpp"
#include "apps/scenes/disturbance.hpp"
#include "apps/scenes/parts.hpp"

namespace nearpose::simulate {
namespace {

// Where the line of sight meets the height of the part's centre, ground frame; never outside of the part's box.
Eigen::Vector2d looked_at(const Part& part, const TaskPath& path) {
    const Eigen::Vector3d size = part.extent.box_max_in_object - part.extent.box_min_in_object;
    const Pose ground_from_camera = path.scene_from_ground.inverse() * path.camera_from_scene.back().inverse();
    const Eigen::Vector3d eye = ground_from_camera.translation;
    const Eigen::Vector3d sight = ground_from_camera.rotation * Eigen::Vector3d::UnitZ();
    const double distance_m = (0.5 * size.z() - eye.z()) / sight.z();
    if (!(distance_m > 0.0) || !std::isfinite(distance_m)) return Eigen::Vector2d::Zero();
    const Eigen::Vector2d half = 0.5 * size.head<2>();
    return (eye + distance_m * sight).head<2>().cwiseMax(-half).cwiseMin(half);
}

void shrink(Mesh& mesh, double factor) {
    for (Eigen::Vector3f& vertex : mesh.vertices_in_object) vertex *= static_cast<float>(factor);
}

}  // namespace

StandIn stand_in(const std::string& part_name, const Part& part, const TaskPath& path, std::uint64_t seed) {
    StandIn other;
    other.mesh = embedded_part(part_name == "flange" ? "engine_block" : "flange").mesh;
    shrink(other.mesh, std::min(1.0, part.extent.diameter_m() / extent_of(other.mesh).diameter_m()));
    const ModelExtent extent = extent_of(other.mesh);
    RandomStream random(seed, 0, 0, kStandInDraw);
    Pose ground_from_other;
    ground_from_other.rotation = Eigen::AngleAxisd(random.uniform(0.0, 2.0 * M_PI), Eigen::Vector3d::UnitZ());
    const Eigen::Vector2d place = looked_at(part, path);
    const double half_height_m = 0.5 * (extent.box_max_in_object - extent.box_min_in_object).z();
    ground_from_other.translation =
        Eigen::Vector3d(place.x(), place.y(), half_height_m) - ground_from_other.rotation * extent.centre_in_object();
    other.scene_from_object = path.scene_from_ground * ground_from_other;
    return other;
}

Mask blob_over(const Mask& mask) {
    Mask blob = mask;
    const data_set::BopBox box = data_set::box_of(mask);
    if (box.u < 0) return blob;
    // Such a box ends on its last pixel.
    const double half_u = 0.5 * box.width + 0.5, half_v = 0.5 * box.height + 0.5;
    const double centre_u = box.u + 0.5 * box.width, centre_v = box.v + 0.5 * box.height;
    for (int v = 0; v < mask.height; ++v) {
        for (int u = 0; u < mask.width; ++u) {
            const double distance = std::hypot((u - centre_u) / half_u, (v - centre_v) / half_v);
            blob.value[static_cast<std::size_t>(v) * mask.width + u] = distance <= 1.0 ? 255 : 0;
        }
    }
    return blob;
}

}  // namespace nearpose::simulate
