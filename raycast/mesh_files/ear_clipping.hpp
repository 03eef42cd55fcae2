// Divides polygons in space, convex or not, into triangles.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace nearpose {

// The triangles of a polygon: its number of corners less two, each as indices into `corners`, wound as the polygon.
// The polygon lies in a plane of any tilt, or nearly so, and does not cross itself. It may touch itself: repeated
// corners, spikes and bridges to holes are allowed. Triangles without area appear where corners repeat, and else only
// where there is no way round them. A polygon that crosses itself is divided somehow.
// Needs three corners or more, all finite. `work` is how many more edges may be looked at, and is diminished; where it
// ends, which takes thousands of corners, no triangles are returned.
std::vector<std::array<int, 3>> triangulate(const std::vector<Eigen::Vector3d>& corners, std::int64_t& work);

}  // namespace nearpose
