// Text OFF. Of its kinds those are read whose first three columns are x, y, z: OFF, COFF with colours, NOFF and CNOFF
// with normals, and with STOFF and so on texture coordinates; all but the place of a vertex is left.
#include <stdexcept>
#include <vector>

#include "raycast/mesh_files/face_writer.hpp"
#include "raycast/mesh_files/readers.hpp"
#include "raycast/mesh_files/text_scanner.hpp"

namespace nearpose {
namespace {

class OffReader {
  public:
    OffReader(std::string_view bytes, const std::string& source, const MeshLimits& limits, MeshRepair& repair)
        : bytes_(bytes), scanner_(bytes), source_(source), limits_(limits), faces_(source, limits, mesh_, repair) {}

    Mesh run() {
        if (bytes_.find('\0') != bytes_.npos) {
            throw std::runtime_error(source_ + ": not a text file; export text OFF");
        }
        check_kind(next_row());
        const std::string_view beside = scanner_.word();
        const std::int64_t num_vertices = count(beside.empty() ? next_row() : beside);
        const std::int64_t num_faces = count(scanner_.word());
        if (num_vertices == 0 || num_faces == 0) fail("the file has no vertices or no faces");
        if (num_vertices > 3 * limits_.max_triangles) {
            fail("more vertices than the limit of " + std::to_string(3 * limits_.max_triangles));
        }
        for (std::int64_t v = 0; v < num_vertices; ++v) read_vertex();
        for (std::int64_t f = 0; f < num_faces; ++f) read_face();
        while (scanner_.next_line()) {
            const std::string_view word = scanner_.word();
            if (!word.empty() && !word.starts_with('#')) fail("more rows than the header says");
        }
        if (mesh_.triangles.empty()) fail("none of the faces has three corners");
        faces_.finish();
        return std::move(mesh_);
    }

  private:
    [[noreturn]] void fail(const std::string& cause) const {
        throw std::runtime_error(source_ + ": line " + std::to_string(scanner_.line_number()) + ": " + cause);
    }

    // [ST][C][N]OFF; 4OFF and nOFF have other coordinates.
    void check_kind(std::string_view magic) const {
        if (magic.starts_with("ST")) magic.remove_prefix(2);
        if (magic.starts_with('C')) magic.remove_prefix(1);
        if (magic.starts_with('N')) magic.remove_prefix(1);
        if (magic != "OFF") fail("the first word is not OFF, COFF, NOFF or alike");
    }

    // The first word of the next line that is neither empty nor a comment.
    std::string_view next_row() {
        while (scanner_.next_line()) {
            const std::string_view word = scanner_.word();
            if (!word.empty() && !word.starts_with('#')) return word;
        }
        fail("the file is cut short");
    }

    std::int64_t count(std::string_view word) const {
        const std::optional<std::int64_t> value = parse_integer(word);
        // No row is shorter than two bytes.
        if (!value || *value < 0 || static_cast<std::uint64_t>(*value) > bytes_.size() / 2) {
            fail("\"" + std::string(word.substr(0, 40)) +
                 "\" rows do not fit into the file: it is cut short or broken");
        }
        return *value;
    }

    void read_vertex() {
        Eigen::Vector3f vertex;
        std::string_view word = next_row();
        for (float& coordinate : vertex.reshaped()) {
            const std::optional<double> value = parse_real(word);
            if (!value) fail("a vertex needs three numbers");
            coordinate = static_cast<float>(*value);
            word = scanner_.word();
        }
        mesh_.vertices_in_object.push_back(vertex);
    }

    void read_face() {
        const std::optional<std::int64_t> num_corners = parse_integer(next_row());
        if (!num_corners || *num_corners < 1) fail("a face has no corners");
        const auto num_vertices = static_cast<std::int64_t>(mesh_.vertices_in_object.size());
        corners_.clear();
        for (std::int64_t k = 0; k < *num_corners; ++k) {
            const std::optional<std::int64_t> index = parse_integer(scanner_.word());
            if (!index || *index < 0 || *index >= num_vertices) fail("a corner of a face does not exist");
            corners_.push_back(static_cast<int>(*index));
        }
        faces_.add(corners_);
    }

    std::string_view bytes_;
    TextScanner scanner_;
    const std::string& source_;
    const MeshLimits& limits_;
    Mesh mesh_;
    FaceWriter faces_;
    std::vector<int> corners_;
};

}  // namespace

Mesh read_off(std::string_view bytes, const std::string& source, const MeshLimits& limits, MeshRepair& repair) {
    return OffReader(bytes, source, limits, repair).run();
}

}  // namespace nearpose
