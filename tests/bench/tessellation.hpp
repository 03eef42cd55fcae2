// The same part in finer and coarser triangles.
#pragma once

#include "raycast/mesh.hpp"

namespace nearpose::bench {

// Each triangle in side x side of its shape: the surface stays what it is.
Mesh tessellate(const Mesh& mesh, int side);

// Vertices within a cell become one, and triangles that lose their area go; the cells are as large as it takes to have
// at most `max_triangles` left: a part that is still like the old one.
Mesh coarsen(const Mesh& mesh, std::size_t max_triangles);

}  // namespace nearpose::bench
