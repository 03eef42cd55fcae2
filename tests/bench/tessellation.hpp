// The same part in finer and coarser triangles.
#pragma once

#include "raycast/mesh.hpp"

namespace nearpose::bench {

// Each triangle in side x side of its shape: the surface stays what it is.
Mesh tessellate(const Mesh& mesh, int side);

// Vertices within a cell of that edge [m] become one, and triangles that lose their area go: a part that is still like
// the old one, of fewer triangles.
Mesh coarsen(const Mesh& mesh, float cell_m);

}  // namespace nearpose::bench
