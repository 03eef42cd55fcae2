// Points drawn on a mesh's surface.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "raycast/mesh.hpp"

namespace nearpose {

struct SurfaceSamples {
    std::vector<Eigen::Vector3f> points_in_object;   // [m]
    std::vector<Eigen::Vector3f> normals_in_object;  // unit, to the side that the triangle's winding says
};

// Draws `count` points, uniform over the area: stratified, one in each of `count` equal parts of the area in the order
// of the triangles. Of a cloud it takes the points themselves, evenly thinned where there are more than `count`. The
// same arguments give the same points with every compiler and standard library. The mesh must be clean; throws
// std::invalid_argument for a count below one, a mesh without area, or a cloud without normals.
SurfaceSamples sample_surface(const Mesh& mesh, int count, std::uint64_t seed);

}  // namespace nearpose
