// Scenes in which there is nothing to find: a plane, a corner, an image of one depth. A tracker must say so.
#pragma once

#include <cstdint>

#include "apps/scenes/disturbance.hpp"
#include "apps/scenes/world.hpp"

namespace nearpose::simulate {

// Whether the scene is made by bare_world in place of the scenario's own.
bool is_bare(SceneContent content);

// What stands in the part's place: a plane at the height of its box (kWall, kConstant), or that plane and a second one
// across it near the point looked at (kCorner). The path's distances are those to the plane.
World bare_world(SceneContent content, const Part& part, const TaskPath& path, std::uint64_t seed);

// The image of a plane across the line of sight, at the depth that `image` has in its middle: every pixel has the same.
RenderedImage with_one_depth(RenderedImage image);

}  // namespace nearpose::simulate
