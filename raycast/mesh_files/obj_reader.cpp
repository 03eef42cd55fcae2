// Vertices and faces of an OBJ file. Not through assimp: its OBJ importer writes beyond its heap blocks on damaged
// files in the version of Debian 12 (5.2.5). Materials are not needed, so that no other file is ever opened.
#include <stdexcept>
#include <vector>

#include "raycast/mesh_files/face_writer.hpp"
#include "raycast/mesh_files/readers.hpp"
#include "raycast/mesh_files/text_scanner.hpp"

namespace nearpose {
namespace {

class ObjReader {
  public:
    ObjReader(std::string_view bytes, const std::string& source, const MeshLimits& limits, MeshRepair& repair)
        : scanner_(bytes), source_(source), limits_(limits), faces_(source, limits, mesh_, repair) {}

    Mesh run() {
        while (scanner_.next_line()) {
            is_comment_ = false;
            const std::string_view keyword = word();
            if (keyword == "v") read_vertex();
            if (keyword == "f") read_face();
        }
        if (mesh_.triangles.empty()) fail("the file has no faces; a point cloud must be a PLY file");
        faces_.finish();
        return std::move(mesh_);
    }

  private:
    [[noreturn]] void fail(const std::string& cause) const {
        throw std::runtime_error(source_ + ": line " + std::to_string(scanner_.line_number()) + ": " + cause);
    }

    // The next word, up to "#" and on to the next line after a backslash at the end.
    std::string_view word() {
        while (!is_comment_) {
            std::string_view found = scanner_.word();
            if (const std::size_t comment = found.find('#'); comment != found.npos) {
                is_comment_ = true;
                return found.substr(0, comment);
            }
            const bool goes_on = found.ends_with('\\') && scanner_.is_line_done();
            if (!goes_on) return found;
            found.remove_suffix(1);
            if (!scanner_.next_line()) is_comment_ = true;
            if (!found.empty()) return found;
        }
        return {};
    }

    void read_vertex() {
        Eigen::Vector3f vertex;
        for (float& coordinate : vertex.reshaped()) {
            const std::optional<double> value = parse_real(word());
            if (!value) fail("a vertex needs three numbers");
            coordinate = static_cast<float>(*value);
        }
        mesh_.vertices_in_object.push_back(vertex);
        if (mesh_.vertices_in_object.size() > 3 * static_cast<std::size_t>(limits_.max_triangles)) {
            fail("more vertices than the limit of " + std::to_string(3 * limits_.max_triangles));
        }
    }

    void read_face() {
        corners_.clear();
        for (std::string_view corner = word(); !corner.empty(); corner = word()) {
            // "vertex/texture/normal": the first is wanted. It counts from 1, or backwards from -1.
            const std::optional<std::int64_t> index = parse_integer(corner.substr(0, corner.find('/')));
            if (!index) fail("\"" + std::string(corner.substr(0, 40)) + "\" is not the corner of a face");
            const auto num_vertices = static_cast<std::int64_t>(mesh_.vertices_in_object.size());
            const std::int64_t place = *index < 0 ? num_vertices + *index : *index - 1;
            // A later line may still bring the vertex of a positive index; clean checks it at the end.
            corners_.push_back(place >= 0 && place < 3 * limits_.max_triangles ? static_cast<int>(place) : -1);
        }
        faces_.add(corners_);
    }

    TextScanner scanner_;
    bool is_comment_ = false;  // what is left of the line
    const std::string& source_;
    const MeshLimits& limits_;
    Mesh mesh_;
    FaceWriter faces_;
    std::vector<int> corners_;
};

}  // namespace

Mesh read_obj(std::string_view bytes, const std::string& source, const MeshLimits& limits, MeshRepair& repair) {
    return ObjReader(bytes, source, limits, repair).run();
}

}  // namespace nearpose
