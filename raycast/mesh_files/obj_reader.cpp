// Vertices and faces of an OBJ file. Not through assimp: its OBJ importer writes beyond its heap blocks on damaged
// files in the version of Debian 12 (5.2.5). Materials are not needed, so that no other file is ever opened.
#include <stdexcept>
#include <vector>

#include "raycast/mesh_files/readers.hpp"
#include "raycast/mesh_files/text_scanner.hpp"

namespace nearpose {

Mesh read_obj(std::string_view bytes, const std::string& source, const MeshLimits& limits, MeshRepair& repair) {
    Mesh mesh;
    TextScanner scanner(bytes);
    const auto fail = [&](const std::string& cause) {
        throw std::runtime_error(source + ": line " + std::to_string(scanner.line_number()) + ": " + cause);
    };
    std::vector<int> corners;
    while (scanner.next_line()) {
        const std::string_view keyword = scanner.word();
        if (keyword == "v") {
            Eigen::Vector3f vertex;
            for (float& coordinate : vertex.reshaped()) {
                const std::optional<double> value = parse_real(scanner.word());
                if (!value) fail("a vertex needs three numbers");
                coordinate = static_cast<float>(*value);
            }
            mesh.vertices_in_object.push_back(vertex);
            if (mesh.vertices_in_object.size() > 3 * static_cast<std::size_t>(limits.max_triangles)) {
                fail("more vertices than the limit of " + std::to_string(3 * limits.max_triangles));
            }
        } else if (keyword == "f") {
            corners.clear();
            for (std::string_view word = scanner.word(); !word.empty(); word = scanner.word()) {
                // "vertex/texture/normal": the first is wanted. It counts from 1, or backwards from -1.
                const std::optional<std::int64_t> index = parse_integer(word.substr(0, word.find('/')));
                if (!index) fail("\"" + std::string(word.substr(0, 40)) + "\" is not the corner of a face");
                const auto num_vertices = static_cast<std::int64_t>(mesh.vertices_in_object.size());
                const std::int64_t corner = *index < 0 ? num_vertices + *index : *index - 1;
                // A later line may still bring the vertex of a positive index; clean checks it at the end.
                corners.push_back(corner >= 0 && corner < 3 * limits.max_triangles ? static_cast<int>(corner) : -1);
            }
            add_polygon(corners.data(), corners.size(), source, limits.max_triangles, mesh, repair);
        }
    }
    if (mesh.triangles.empty()) fail("the file has no faces; a point cloud must be a PLY file");
    return mesh;
}

}  // namespace nearpose
