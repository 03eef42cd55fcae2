// One reader of model files, and what is done with every model: no bytes may crash it, make it hang or take gigabytes.
// What it returns must be usable.
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string_view>

#include "raycast/mesh_files/readers.hpp"
#include "raycast/mesh_pieces.hpp"

namespace nearpose {
namespace {

constexpr std::string_view kFormat = NEARPOSE_FUZZED;

Mesh read(std::string_view bytes, const MeshLimits& limits) {
    MeshRepair repair;
    // Where a .gltf may look for buffers: nothing is there.
    static const std::filesystem::path folder = "/nowhere";
    if (kFormat == "ply") return read_ply(bytes, "fuzzed", limits, repair);
    if (kFormat == "obj") return read_obj(bytes, "fuzzed", limits, repair);
    if (kFormat == "stl") return read_stl(bytes, "fuzzed", limits);
    if (kFormat == "off") return read_off(bytes, "fuzzed", limits, repair);
    return read_gltf(bytes, "fuzzed", folder, limits, repair);
}

void require(bool holds) {
    if (!holds) std::abort();
}

void check(const Mesh& mesh) {
    for (const Eigen::Vector3f& vertex : mesh.vertices_in_object) require(vertex.allFinite());
    const auto num_vertices = static_cast<int>(mesh.vertices_in_object.size());
    for (const auto& triangle : mesh.triangles) {
        for (const int corner : triangle) require(corner >= 0 && corner < num_vertices);
    }
    require(find_stray_pieces(mesh).is_stray.size() == mesh.triangles.size());
}

}  // namespace
}  // namespace nearpose

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    nearpose::MeshLimits limits;
    limits.max_triangles = 100'000;
    limits.max_file_bytes = 1U << 20U;
    try {
        const std::string_view bytes(reinterpret_cast<const char*>(data), size);
        nearpose::check(nearpose::clean(nearpose::read(bytes, limits), "fuzzed"));
    } catch (const std::runtime_error&) {
        // Refused, with a cause.
    }
    return 0;
}
