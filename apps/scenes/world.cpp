#include "apps/scenes/world.hpp"

#include <algorithm>
#include <cmath>

#include "apps/scenes/clutter_world.hpp"

namespace nearpose::simulate {
namespace {

// Half the side of the table: far enough for a whole view of the part to show the table around it.
double table_half_side_m(const Part& part, const TaskPath& path) {
    const double half_m = 1.5 * part.extent.diameter_m();
    const Pose scene_from_camera = path.camera_from_scene.front().inverse();
    const Pose first = scene_from_camera * path.camera_from_object.front();
    const Eigen::Vector3d centre = part.extent.centre_in_object();
    // A part on a conveyor needs as much belt as it goes.
    return half_m + (first * centre - centre).norm();
}

// Four walls that stand close around all copies.
Mesh walls_in_ground(const Part& part, const std::vector<Pose>& ground_from_copies) {
    Eigen::AlignedBox3d box(part.extent.box_min_in_object, part.extent.box_max_in_object);
    const Eigen::Vector3d size = box.sizes();
    Eigen::AlignedBox2d area(Eigen::Vector2d(-0.5 * size.head<2>()), Eigen::Vector2d(0.5 * size.head<2>()));
    for (const Pose& pose : ground_from_copies) {
        for (int corner = 0; corner < 8; ++corner) {
            area.extend((pose * box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner))).head<2>());
        }
    }
    const double gap_m = 0.02 * size.norm(), thick_m = 0.01 * size.norm(), height_m = 0.7 * size.z();
    const Eigen::Vector2d a = area.min().array() - gap_m, b = area.max().array() + gap_m;
    Mesh walls;
    const auto wall = [&](double x0, double y0, double x1, double y1) {
        append(walls, box_mesh({x0, y0, 0.0}, {x1, y1, height_m}), Pose::identity());
    };
    wall(a.x() - thick_m, a.y() - thick_m, a.x(), b.y() + thick_m);
    wall(b.x(), a.y() - thick_m, b.x() + thick_m, b.y() + thick_m);
    wall(a.x(), a.y() - thick_m, b.x(), a.y());
    wall(a.x(), b.y(), b.x(), b.y() + thick_m);
    return walls;
}

}  // namespace

Mesh box_mesh(const Eigen::Vector3d& corner, const Eigen::Vector3d& opposite) {
    Mesh box;
    for (int i = 0; i < 8; ++i) {
        box.vertices_in_object.emplace_back(Eigen::Vector3d((i & 1) != 0 ? opposite.x() : corner.x(),
                                                            (i & 2) != 0 ? opposite.y() : corner.y(),
                                                            (i & 4) != 0 ? opposite.z() : corner.z())
                                                .cast<float>());
    }
    box.triangles = {{0, 3, 1}, {0, 2, 3}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                     {2, 7, 3}, {2, 6, 7}, {0, 6, 2}, {0, 4, 6}, {1, 3, 7}, {1, 7, 5}};
    return box;
}

void append(Mesh& mesh, const Mesh& other, const Pose& mesh_from_other) {
    const int first = static_cast<int>(mesh.vertices_in_object.size());
    for (const Eigen::Vector3f& vertex : other.vertices_in_object) {
        mesh.vertices_in_object.emplace_back((mesh_from_other * vertex.cast<double>().eval()).cast<float>());
    }
    for (const auto& [a, b, c] : other.triangles) mesh.triangles.push_back({first + a, first + b, first + c});
}

World world_of(Scenario scenario, const Mesh& mesh, const Part& part, const TaskPath& path, const PinholeCamera& camera,
               std::uint64_t seed, const WorldOptions& options) {
    World world;
    double table_half_m = table_half_side_m(part, path);
    if (scenario == Scenario::kBin) {
        const std::vector<Pose> ground_from_copies = pushed_together(part, seed);
        for (const Pose& pose : ground_from_copies) world.copies.push_back(path.scene_from_ground * pose);
        table_half_m *= 2.0;
        if (options.with_table) {
            append(world.surroundings_in_scene, walls_in_ground(part, ground_from_copies), path.scene_from_ground);
        }
    }
    if (options.with_table) world.table = Table{path.scene_from_ground, table_half_m};
    if (scenario == Scenario::kClutter) add_clutter(world, mesh, part, path, camera, seed, options);
    return world;
}

}  // namespace nearpose::simulate
