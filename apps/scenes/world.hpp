// What stands around the part.
#pragma once

#include <optional>
#include <vector>

#include "apps/scenes/scenario.hpp"
#include "core/base/pose.hpp"
#include "raycast/mesh.hpp"

namespace nearpose::simulate {

// Another part than the tracked one.
struct OtherPart {
    Mesh mesh;
    int object_id = 0;  // 0: the data set does not have it, so the truth does not speak of it
    Pose scene_from_object;
};

// A square of a plane: the ground frame's z = 0 around its origin.
struct Table {
    Pose scene_from_ground;
    double half_side_m = 0.0;
};

struct World {
    std::vector<Pose> copies;  // scene_from_object of further copies of the part
    std::optional<OtherPart> other;
    std::optional<Table> table;
    Mesh surroundings_in_scene;  // boxes, walls; empty: nothing
    Mesh gripper_in_camera;      // moves with the camera; empty: none
};

struct WorldOptions {
    bool with_table = true;           // and the walls of the bin
    std::optional<double> occlusion;  // clutter
    std::string part_name;            // of parts.hpp, empty for any other: clutter takes another one beside it
};

World world_of(Scenario scenario, const Mesh& mesh, const Part& part, const TaskPath& path, const PinholeCamera& camera,
               std::uint64_t seed, const WorldOptions& options);

// Boxes, for whatever is made of them.
Mesh box_mesh(const Eigen::Vector3d& corner, const Eigen::Vector3d& opposite);
void append(Mesh& mesh, const Mesh& other, const Pose& mesh_from_other);

// Where further copies of a part lie around the first in a grid of 3 x 3: ground_from_object, each turned by a drawn
// angle about the vertical, some turned over, and pushed until the box around it touches a box that lies there already.
// The first lies with the sides of its box along the ground's axes, over its origin.
std::vector<Pose> pushed_together(const Part& part, std::uint64_t seed);

}  // namespace nearpose::simulate
