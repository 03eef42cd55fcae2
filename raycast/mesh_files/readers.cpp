#include "raycast/mesh_files/readers.hpp"

#include <fstream>
#include <stdexcept>

namespace nearpose {

std::string read_regular_file(const std::filesystem::path& path, std::uint64_t max_bytes) {
    std::error_code error;
    const std::filesystem::file_status status = std::filesystem::status(path, error);
    if (!std::filesystem::exists(status)) throw std::runtime_error(path.string() + ": no such file");
    if (!std::filesystem::is_regular_file(status)) throw std::runtime_error(path.string() + ": not a regular file");
    const std::uintmax_t size = std::filesystem::file_size(path, error);
    if (error) throw std::runtime_error(path.string() + ": " + error.message());
    if (size > max_bytes) {
        throw std::runtime_error(path.string() + ": " + std::to_string(size) + " bytes are more than the limit of " +
                                 std::to_string(max_bytes));
    }
    std::string bytes(static_cast<std::size_t>(size), '\0');
    std::ifstream file(path, std::ios::binary);
    if (!file.read(bytes.data(), static_cast<std::streamsize>(size))) {
        throw std::runtime_error(path.string() + ": cannot be read");
    }
    return bytes;
}

void add_polygon(const int* corners, std::size_t num_corners, const std::string& source, std::int64_t max_triangles,
                 Mesh& mesh, MeshRepair& repair) {
    if (num_corners < 3) {
        ++repair.triangles_degenerate;
        return;
    }
    if (mesh.triangles.size() + num_corners - 2 > static_cast<std::size_t>(max_triangles)) {
        throw std::runtime_error(source + ": more triangles than the limit of " + std::to_string(max_triangles));
    }
    for (std::size_t k = 2; k < num_corners; ++k) mesh.triangles.push_back({corners[0], corners[k - 1], corners[k]});
}

}  // namespace nearpose
