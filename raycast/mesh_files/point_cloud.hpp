// What a dense point cloud needs to be seen as a surface.
#pragma once

#include "raycast/mesh.hpp"

namespace nearpose {

// Sets the disc radius of a cloud from the spacing of its points where it has none, so that the discs close the
// surface, and estimates its normals where it has none. Their sign is arbitrary: views turn them towards the camera.
// The cloud must be clean. Throws std::invalid_argument for fewer than five points.
void complete_cloud(Mesh& cloud);

}  // namespace nearpose
