// Binary and text STL. In text what exporters write otherwise than the format says is read where its meaning is plain:
// capitals, and "end loop" for "endloop". Normals are not used: they follow from the corners.
#include <bit>
#include <cctype>
#include <cstring>
#include <stdexcept>

#include "raycast/mesh_files/readers.hpp"
#include "raycast/mesh_files/text_scanner.hpp"

namespace nearpose {
namespace {

constexpr std::size_t kHeaderBytes = 84;    // 80 of text, 4 of the number of triangles
constexpr std::size_t kTriangleBytes = 50;  // normal, three corners, two bytes of attributes
constexpr std::size_t kNormalBytes = 12;

static_assert(std::endian::native == std::endian::little, "numbers are copied as they stand");

void require_in_limits(std::uint64_t num_triangles, const std::string& source, const MeshLimits& limits) {
    if (num_triangles == 0) throw std::runtime_error(source + ": the file has no triangles");
    if (num_triangles > static_cast<std::uint64_t>(limits.max_triangles)) {
        throw std::runtime_error(source + ": " + std::to_string(num_triangles) +
                                 " triangles are more than the limit of " + std::to_string(limits.max_triangles));
    }
}

// Of the last three vertices.
void add_triangle(Mesh& mesh) {
    const int end = static_cast<int>(mesh.vertices_in_object.size());
    mesh.triangles.push_back({end - 3, end - 2, end - 1});
}

Mesh binary_mesh(std::string_view bytes, std::uint32_t num_triangles) {
    Mesh mesh;
    mesh.triangles.reserve(num_triangles);
    mesh.vertices_in_object.reserve(3 * std::size_t{num_triangles});
    const char* corners = bytes.data() + kHeaderBytes + kNormalBytes;
    for (std::uint32_t t = 0; t < num_triangles; ++t, corners += kTriangleBytes) {
        for (std::size_t k = 0; k < 3; ++k) {
            Eigen::Vector3f corner;
            std::memcpy(corner.data(), corners + 12 * k, 12);
            mesh.vertices_in_object.push_back(corner);
        }
        add_triangle(mesh);
    }
    return mesh;
}

std::string lower_case(std::string_view word) {
    std::string lower(word.substr(0, 40));
    for (char& letter : lower) letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
    return lower;
}

// Facets of a normal and three vertices, of three numbers each, in solids that end.
class TextStlReader {
  public:
    TextStlReader(std::string_view bytes, const std::string& source, const MeshLimits& limits)
        : scanner_(bytes), source_(source), limits_(limits) {}

    Mesh run() {
        while (scanner_.next_line()) {
            std::string keyword = lower_case(scanner_.word());
            if (keyword == "end") keyword += lower_case(scanner_.word());
            if (keyword == "solid" || keyword == "endsolid") {
                if (in_solid_ == (keyword == "solid")) fail("a solid without an end or a beginning");
                in_solid_ = !in_solid_;
            } else if (keyword == "facet") {
                if (in_facet_ || lower_case(scanner_.word()) != "normal") fail("a facet without a normal or an end");
                three_numbers("a normal");
                in_facet_ = true;
            } else if (keyword == "vertex") {
                mesh_.vertices_in_object.push_back(three_numbers("a vertex"));
                if (++corners_ > 3) fail("a facet with more than three vertices");
            } else if (keyword == "endfacet") {
                end_facet();
            } else if (!keyword.empty() && keyword != "outer" && keyword != "endloop") {
                fail("unknown keyword \"" + keyword + "\"");
            }
        }
        if (in_solid_ || in_facet_ || corners_ != 0) fail("the file ends without \"endsolid\": it is cut short");
        require_in_limits(mesh_.triangles.size(), source_, limits_);
        return std::move(mesh_);
    }

  private:
    [[noreturn]] void fail(const std::string& cause) const {
        throw std::runtime_error(source_ + ": line " + std::to_string(scanner_.line_number()) + ": " + cause);
    }

    Eigen::Vector3f three_numbers(const std::string& what) {
        Eigen::Vector3f numbers;
        for (float& number : numbers.reshaped()) {
            const std::optional<double> value = parse_real(scanner_.word());
            if (!value) fail(what + " needs three numbers");
            number = static_cast<float>(*value);
        }
        return numbers;
    }

    void end_facet() {
        if (!in_facet_ || corners_ != 3) fail("a facet without a beginning or three vertices");
        in_facet_ = false;
        corners_ = 0;
        add_triangle(mesh_);
        require_in_limits(mesh_.triangles.size(), source_, limits_);
    }

    TextScanner scanner_;
    const std::string& source_;
    const MeshLimits& limits_;
    Mesh mesh_;
    int corners_ = 0;  // of the facet at hand
    bool in_solid_ = false;
    bool in_facet_ = false;
};

bool begins_as_text(std::string_view bytes) {
    const std::string_view begin = bytes.substr(0, 1024);
    TextScanner scanner(begin);
    return begin.find('\0') == begin.npos && scanner.next_line() && lower_case(scanner.word()) == "solid";
}

}  // namespace

Mesh read_stl(std::string_view bytes, const std::string& source, const MeshLimits& limits) {
    // Binary files may begin with "solid" too; their size tells them.
    std::uint32_t num_triangles = 0;
    if (bytes.size() >= kHeaderBytes) std::memcpy(&num_triangles, bytes.data() + kHeaderBytes - 4, 4);
    const std::uint64_t binary_size = kHeaderBytes + kTriangleBytes * std::uint64_t{num_triangles};
    const bool is_text = bytes.size() != binary_size && begins_as_text(without_byte_order_mark(bytes));
    if (is_text) return TextStlReader(without_byte_order_mark(bytes), source, limits).run();

    if (bytes.size() < kHeaderBytes) throw std::runtime_error(source + ": too short for an STL file");
    // Less than a triangle more cannot be one that was left out of the count.
    const bool has_all =
        bytes.size() >= binary_size && (bytes.size() < binary_size + kTriangleBytes ||
                                        is_padding(bytes.substr(static_cast<std::size_t>(binary_size))));
    if (!has_all) {
        const std::string difference = bytes.size() < binary_size ? "cut short" : "too long";
        throw std::runtime_error(source + ": as a binary STL file of " + std::to_string(num_triangles) +
                                 " triangles it would have " + std::to_string(binary_size) + " bytes, not " +
                                 std::to_string(bytes.size()) + ": it is " + difference + " or not an STL file");
    }
    require_in_limits(num_triangles, source, limits);
    return binary_mesh(bytes, num_triangles);
}

}  // namespace nearpose
