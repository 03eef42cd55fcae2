#include "apps/scenes/bare_scene.hpp"

#include <cmath>

#include "apps/base/simulation_draws.hpp"

namespace nearpose::simulate {

bool is_bare(SceneContent content) {
    return content == SceneContent::kWall || content == SceneContent::kCorner || content == SceneContent::kConstant;
}

World bare_world(SceneContent content, const Part& part, const TaskPath& path, std::uint64_t seed) {
    constexpr double kHalfSide_m = 3.0, kThick_m = 0.02, kMostBeside_m = 0.06;
    const double height_m = (part.extent.box_max_in_object - part.extent.box_min_in_object).z();
    Pose ground_from_plane;
    ground_from_plane.translation.z() = height_m;
    World world;
    world.table = Table{path.scene_from_ground * ground_from_plane, kHalfSide_m};
    if (content != SceneContent::kCorner) return world;
    // The second plane stands beside the point on which the last frame's line of sight meets the first.
    const Pose plane_from_camera = world.table->scene_from_ground.inverse() * path.camera_from_scene.back().inverse();
    const Eigen::Vector3d eye = plane_from_camera.translation;
    const Eigen::Vector3d sight = plane_from_camera.rotation * Eigen::Vector3d::UnitZ();
    RandomStream random(seed, 0, 0, kBareSceneDraw);
    Pose plane_from_wall;
    plane_from_wall.rotation = Eigen::AngleAxisd(random.uniform(0.0, 2.0 * M_PI), Eigen::Vector3d::UnitZ());
    plane_from_wall.translation = eye - eye.z() / sight.z() * sight;
    const double beside_m = random.uniform(0.0, kMostBeside_m);
    append(world.surroundings_in_scene,
           box_mesh({beside_m, -kHalfSide_m, -kThick_m}, {beside_m + kThick_m, kHalfSide_m, kHalfSide_m}),
           world.table->scene_from_ground * plane_from_wall);
    return world;
}

RenderedImage with_one_depth(RenderedImage image) {
    DepthImage& depth = image.depth;
    const float middle_m = depth.depth_m[static_cast<std::size_t>(depth.height / 2) * depth.width + depth.width / 2];
    depth.depth_m.assign(depth.depth_m.size(), middle_m);
    image.normals_in_camera.assign(image.normals_in_camera.size(), -Eigen::Vector3f::UnitZ());
    return image;
}

}  // namespace nearpose::simulate
