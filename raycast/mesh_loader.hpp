// Mesh files: PLY (also a dense point cloud), STL, OBJ, OFF, glTF 2 and GLB.
//
// glTF goes through assimp, of which only that importer is left, after a check of the whole document. All others have
// readers of their own. Faces may have any number of corners and be concave. COLLADA (.dae) and 3MF are refused, since
// their importers crash on damaged files: export PLY, STL or OBJ.
//
// A file is hostile until checked: sizes are compared with the bytes of the file before anything is allocated, every
// index is checked, and nothing but the file itself (for glTF also regular files of its folder) is opened.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "raycast/mesh.hpp"

namespace nearpose {

// Unit of the lengths in a file. No mesh format but glTF (metres) says it.
enum class LengthUnit { kMetre, kMillimetre, kCentimetre, kInch };

// "m", "mm", "cm", "in" or the words "metre", "millimetre", "centimetre", "inch"; throws std::invalid_argument
// otherwise.
LengthUnit parse_length_unit(std::string_view text);
// The short name: "m", "mm", "cm", "in".
const char* to_string(LengthUnit unit);
// Metres in one unit.
double metres_per(LengthUnit unit);

// What is refused rather than tried.
struct MeshLimits {
    std::uint64_t max_file_bytes = std::uint64_t{1} << 30;
    std::int64_t max_triangles = 20'000'000;  // also of points of a cloud, and a third of the vertices before joining
    double min_diameter_m = 1e-3;             // diameters outside this range mean a wrong unit
    double max_diameter_m = 20.0;
    int max_json_depth = 64;               // glTF: brackets in brackets
    int max_json_values = 2'000'000;       // glTF
    int max_node_depth = 256;              // glTF: nodes in nodes
    std::int64_t max_instances = 100'000;  // glTF: nodes, counted as often as they are placed
};

struct LoadedMesh {
    Mesh mesh;
    MeshRepair repair;
};

// Reads, converts to metres, cleans and checks the size of the mesh. The format goes by the file's extension. glTF is
// in metres by its specification, unless its writer erred: `unit` is applied to it as to all others. A PLY file without
// faces is a dense cloud: its disc radius comes from the spacing of its points, and normals are estimated where the
// file has none. Throws std::runtime_error that names the file and the cause.
LoadedMesh load_mesh(const std::filesystem::path& path, LengthUnit unit, const MeshLimits& limits = {});
// The same for a PLY file that is in memory already; `source` names it in errors.
LoadedMesh load_mesh_from_bytes(std::string_view ply, const std::string& source, LengthUnit unit,
                                const MeshLimits& limits = {});

// The vertices as the file lists them, also equal ones and those of no triangle: what error measures are defined over.
// [m], with the digits of the file's own unit. Throws std::runtime_error where one is not finite or there is none.
std::vector<Eigen::Vector3d> load_vertices(const std::filesystem::path& path, LengthUnit unit,
                                           const MeshLimits& limits = {});

// Writes a binary little-endian PLY of the types float, uchar and int alone (what other tools' simplest readers take):
// vertices, normals if there are any, and triangles. The file appears whole or not at all. Throws std::runtime_error.
void save_ply(const Mesh& mesh, const std::filesystem::path& path, LengthUnit unit);

}  // namespace nearpose
