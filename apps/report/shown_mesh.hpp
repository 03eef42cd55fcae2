// The model as the page shows it.
#pragma once

#include "raycast/mesh.hpp"

namespace nearpose::report {

// `mesh` where it has at most `max_triangles` (of a cloud, points); else one with fewer: vertices in one cell of a grid
// become their mean. Shapes smaller than a cell are lost, which a picture of a part hardly shows.
Mesh shown_mesh(const Mesh& mesh, std::size_t max_triangles);

}  // namespace nearpose::report
