// Readers of one file format each. They take the whole file as bytes, so that every size can be compared with what is
// there, and return lengths in the file's own unit. A corner that does not exist becomes -1, which clean counts.
// `source` names the file in errors (std::runtime_error).
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "raycast/mesh_loader.hpp"

namespace nearpose {

// The bytes of a regular file of at most `max_bytes`; pipes and devices, which might never end, are refused.
std::string read_regular_file(const std::filesystem::path& path, std::uint64_t max_bytes);

Mesh read_ply(std::string_view bytes, const std::string& source, const MeshLimits& limits, MeshRepair& repair);
Mesh read_stl(std::string_view bytes, const std::string& source, const MeshLimits& limits, MeshRepair& repair);
Mesh read_off(std::string_view bytes, const std::string& source, const MeshLimits& limits, MeshRepair& repair);
Mesh read_obj(std::string_view bytes, const std::string& source, const MeshLimits& limits, MeshRepair& repair);
// `folder` is where the buffers of a .gltf are looked for.
Mesh read_gltf(std::string_view bytes, const std::string& source, const std::filesystem::path& folder,
               const MeshLimits& limits, MeshRepair& repair);

// Adds a polygon as a fan of triangles; counts it as degenerate where it has fewer than three corners. Throws
// std::runtime_error where the mesh would pass `max_triangles`.
void add_polygon(const int* corners, std::size_t num_corners, const std::string& source, std::int64_t max_triangles,
                 Mesh& mesh, MeshRepair& repair);

}  // namespace nearpose
