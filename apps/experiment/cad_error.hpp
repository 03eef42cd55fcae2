// Meshes that are not what the camera sees: faults of CAD files.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "raycast/mesh.hpp"

namespace nearpose::experiment {

// true                  the mesh as it is
// mirrored              x -> -x about the centre of the box, with the triangles' winding turned
// wrong_unit            centimetres for inches: 2.54 times too large
// scaled                0.2 % too large, as a casting that shrank less than it was to
// missing_boss          without the triangles that lie within a ball of 0.08 diameters of the box about a drawn point
// of
//                       the surface; of several draws the first of which at least a quarter of the ball's cross-section
//                       goes
// scaled_missing_boss   both
const std::vector<std::string>& cad_words();

// All about the centre of the box, so that a pose still says where the part's middle is. Throws std::invalid_argument
// for another word, a cloud without a boss, and a mesh of triangles too large to lie in such a ball.
Mesh with_cad_error(const Mesh& mesh, const std::string& cad, std::uint64_t seed);

// Whether the error depends on the seed.
bool is_drawn(const std::string& cad);

}  // namespace nearpose::experiment
