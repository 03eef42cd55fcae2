// Readers of one file format each. They take the whole file as bytes, so that every size can be compared with what is
// there, and return lengths in the file's own unit. A corner that does not exist becomes -1, which clean counts.
// `source` names the file in errors (std::runtime_error).
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "raycast/mesh_loader.hpp"

namespace nearpose {

// `text` without the three bytes that some programs put before UTF-8.
std::string_view without_byte_order_mark(std::string_view text);
// True if there are only blanks, ends of lines and zeros.
bool is_padding(std::string_view bytes);

// The bytes of a regular file of at most `max_bytes`; pipes and devices, which might never end, are refused.
std::string read_regular_file(const std::filesystem::path& path, std::uint64_t max_bytes);

Mesh read_ply(std::string_view bytes, const std::string& source, const MeshLimits& limits, MeshRepair& repair);
Mesh read_stl(std::string_view bytes, const std::string& source, const MeshLimits& limits);
Mesh read_off(std::string_view bytes, const std::string& source, const MeshLimits& limits, MeshRepair& repair);
Mesh read_obj(std::string_view bytes, const std::string& source, const MeshLimits& limits, MeshRepair& repair);
// `folder` is where the buffers of a .gltf are looked for.
Mesh read_gltf(std::string_view bytes, const std::string& source, const std::filesystem::path& folder,
               const MeshLimits& limits, MeshRepair& repair);

}  // namespace nearpose
