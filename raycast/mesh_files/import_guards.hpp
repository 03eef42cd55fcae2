// Checks of a whole STL or OFF file before the importer sees it. The importer refuses such files without the cause, or
// loads what it can: a comma ends a number, a cut file loses its end, a corner that does not exist becomes another.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "raycast/mesh_loader.hpp"

namespace nearpose {

// Each returns how many triangles the importer must find in `bytes`, and throws std::runtime_error that names `source`
// and the cause for a file that is broken, cut short, longer than it says, or above the limits.
std::uint64_t checked_stl_triangles(std::string_view bytes, const std::string& source, const MeshLimits& limits);
// A polygon of n corners counts as n - 2 triangles.
std::uint64_t checked_off_triangles(std::string_view bytes, const std::string& source, const MeshLimits& limits);

}  // namespace nearpose
