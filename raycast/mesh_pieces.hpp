// The connected pieces of a mesh, and which of them hardly belong to the part: an export may hold what was left lying
// in the scene, or the floor.
#pragma once

#include <cstdint>
#include <vector>

#include "raycast/mesh.hpp"

namespace nearpose {

// For each triangle the number of its piece: triangles that share a vertex belong together. Numbers count from 0 on.
std::vector<int> connected_pieces(const Mesh& mesh);

struct StrayPieces {
    // Pieces farther from the rest than half the rest's diameter.
    std::int64_t far_pieces = 0;
    std::int64_t far_triangles = 0;
    double distance_m = 0.0;  // of the nearest of them, from box to box
    // Pieces in one plane, at least twice as large as the rest.
    std::int64_t flat_triangles = 0;
    double flat_diameters = 0.0;  // their diameter in diameters of the rest
    std::vector<bool> is_stray;   // of each triangle of the mesh

    bool empty() const { return far_triangles == 0 && flat_triangles == 0; }
};

// The mesh must be clean. The rest is what lies around the piece of the most triangles. Nothing of a cloud is stray.
StrayPieces find_stray_pieces(const Mesh& mesh);

// The mesh without them.
Mesh without(const StrayPieces& strays, const Mesh& mesh);

}  // namespace nearpose
