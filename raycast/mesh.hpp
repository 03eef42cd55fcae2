// The model's surface: triangles, or the points of a dense cloud. Metres, object frame.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/view_generator.hpp"

namespace nearpose {

struct Mesh {
    std::vector<Eigen::Vector3f> vertices_in_object;        // [m]
    std::vector<Eigen::Vector3f> vertex_normals_in_object;  // unit; empty unless it is a cloud with normals
    std::vector<std::array<int, 3>> triangles;              // indices of vertices, in either winding
    float disc_radius_m = 0.0F;                             // of a cloud: each point stands for a disc of this radius

    bool is_cloud() const { return triangles.empty(); }
};

// The box around all vertices; the mesh must have at least one and all must be finite (clean sees to it).
ModelExtent extent_of(const Mesh& mesh);

// The area of all triangles, or of all discs of a cloud, each counted in full [m^2].
double surface_area_m2(const Mesh& mesh);

// What was wrong with a mesh and left out of it.
struct MeshRepair {
    std::int64_t triangles_degenerate = 0;  // without area, or with a corner twice
    std::int64_t triangles_not_finite = 0;  // with a corner that is NaN or infinite
    std::int64_t triangles_bad_index = 0;   // with a corner that does not exist
    std::int64_t vertices_not_finite = 0;
    std::int64_t vertices_joined = 0;  // equal to an earlier vertex; no fault, STL stores every corner three times
};

// Returns `mesh` without what a ray caster cannot handle: vertices that are not finite and their triangles, triangles
// of an area below (1e-7 * diameter)^2, indices out of range. Equal vertices are joined, and vertices without a
// triangle dropped; of a cloud only the points that are not finite go. Adds to the counts of `repair` where one is
// given. Throws std::runtime_error, naming `source` (a file or what the mesh was made from), if nothing is left.
Mesh clean(Mesh mesh, const std::string& source, MeshRepair* repair = nullptr);

}  // namespace nearpose
