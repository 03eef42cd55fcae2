// Checks of a glTF 2 document before the importer sees it.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "raycast/mesh_files/json_outline.hpp"
#include "raycast/mesh_loader.hpp"

namespace nearpose {

// Returns a document with the geometry of `json` alone: nodes, meshes (positions and indices) and the buffers under
// them. All else (materials, images, skins, animations, extensions) never reaches the importer. In what is left every
// index, offset and size has been checked, nodes form no cycle, and their instances are counted.
// `binary_chunk_bytes` is the size of a GLB's second chunk, 0 for a .gltf. Buffers in files of their own must be
// regular files in `folder`. Throws std::runtime_error that names `source` and the cause.
std::string checked_gltf(std::string_view json, std::uint64_t binary_chunk_bytes, const std::string& source,
                         const std::filesystem::path& folder, const MeshLimits& limits);

// The same for a GLB: returns one with the checked document and the binary chunk.
std::string checked_glb(std::string_view bytes, const std::string& source, const std::filesystem::path& folder,
                        const MeshLimits& limits);
bool is_glb_file(std::string_view bytes);

// The name of the file that a `uri` means: "%20" and its like stand for a byte. Empty where it is no plain name.
std::string file_name_of(std::string_view uri);
// True if `name` can be opened: a plain name in `folder` of a regular file, no link.
bool is_own_file(const std::filesystem::path& folder, std::string_view name);

}  // namespace nearpose
