// Where a part's surface is, for a camera that comes down to a point of it.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "raycast/mesh.hpp"

namespace nearpose::simulate {

// Points of the surface [m] that are seen from straight above, near the top (so that a camera may come close to them
// and meets nothing else), and face upwards. Never empty.
std::vector<Eigen::Vector3d> surface_points_from_above(const Mesh& mesh);

}  // namespace nearpose::simulate
