#include <unistd.h>

#include <bit>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <system_error>

#include "raycast/mesh_loader.hpp"

namespace nearpose {
namespace {

static_assert(std::endian::native == std::endian::little, "the writer copies numbers as they are");

template <typename T>
void put(std::ostream& out, const T* values, std::size_t count) {
    out.write(reinterpret_cast<const char*>(values), static_cast<std::streamsize>(count * sizeof(T)));
}

void write_ply(std::ostream& out, const Mesh& mesh, LengthUnit unit) {
    const bool has_normals =
        !mesh.vertices_in_object.empty() && mesh.vertex_normals_in_object.size() == mesh.vertices_in_object.size();
    out << "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(mesh.vertices_in_object.size()) +
               "\nproperty float x\nproperty float y\nproperty float z\n";
    if (has_normals) out << "property float nx\nproperty float ny\nproperty float nz\n";
    if (!mesh.is_cloud()) {
        out << "element face " + std::to_string(mesh.triangles.size()) + "\nproperty list uchar int vertex_indices\n";
    }
    out << "end_header\n";
    for (std::size_t i = 0; i < mesh.vertices_in_object.size(); ++i) {
        const Eigen::Vector3d in_unit = mesh.vertices_in_object[i].cast<double>() / metres_per(unit);
        const Eigen::Vector3f vertex = in_unit.cast<float>();
        put(out, vertex.data(), 3);
        if (has_normals) put(out, mesh.vertex_normals_in_object[i].data(), 3);
    }
    const unsigned char num_corners = 3;
    for (const auto& triangle : mesh.triangles) {
        put(out, &num_corners, 1);
        put(out, triangle.data(), 3);
    }
}

}  // namespace

void save_ply(const Mesh& mesh, const std::filesystem::path& path, LengthUnit unit) {
    std::filesystem::path temporary = path;
    temporary += ".tmp" + std::to_string(::getpid());
    errno = 0;
    std::ofstream out(temporary, std::ios::binary | std::ios::trunc);
    if (out) write_ply(out, mesh, unit);
    // A full disk shows at the flush at the latest.
    out.close();
    std::error_code error;
    if (out)
        std::filesystem::rename(temporary, path, error);
    else
        error = {errno != 0 ? errno : EIO, std::generic_category()};
    if (!error) return;
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
    throw std::runtime_error(path.string() + ": cannot be written: " + error.message() +
                             "; name a folder that exists, on a disk with room");
}

}  // namespace nearpose
