// What makes a mesh look otherwise than its part: faces that are missing, and surface that nobody sees.
#pragma once

#include "raycast/mesh.hpp"

namespace nearpose {

struct MeshFaults {
    // Shares of the edges, after vertices within 1e-5 diameters were joined.
    double open_edges = 0.0;     // that belong to one triangle alone
    double crowded_edges = 0.0;  // that belong to more than two
    // Shares that rays from points strewn over the surface give.
    double see_through = 0.0;  // of the directions in which one sees out from the surface's inner side
    double hidden = 0.0;       // of the surface from which neither side is seen from outside

    // Faces are missing: where pieces' edges merely do not fit together, nothing is seen through them; and of a scan
    // that is open below few edges are open.
    bool has_holes() const { return open_edges > 0.1 && see_through > 0.05; }
    // As much is hidden as is seen: a second shell. Inner bodies that are smaller change no view.
    bool has_second_shell() const { return hidden > 0.45; }
    bool is_double() const { return crowded_edges > 0.5; }
};

// The mesh must be clean. Rays are cast only where edges or several pieces give reason to; a mesh above `max_triangles`
// and a cloud are without faults.
MeshFaults find_faults(const Mesh& mesh, std::size_t max_triangles = 300'000);

}  // namespace nearpose
