// The things of the clutter scenario.
#pragma once

#include "apps/scenes/world.hpp"

namespace nearpose::simulate {

// Adds boxes and another part around the part, and a gripper before the camera that reaches so far into the image that,
// in the frame where most is hidden, the wanted fraction of the silhouette is. Where boxes alone would hide more, they
// are made lower.
void add_clutter(World& world, const Mesh& mesh, const Part& part, const TaskPath& path, const PinholeCamera& camera,
                 std::uint64_t seed, const WorldOptions& options);

}  // namespace nearpose::simulate
