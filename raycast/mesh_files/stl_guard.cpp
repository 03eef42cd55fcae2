#include <bit>
#include <cstring>
#include <stdexcept>

#include "raycast/mesh_files/import_guards.hpp"
#include "raycast/mesh_files/text_scanner.hpp"

namespace nearpose {
namespace {

constexpr std::size_t kHeaderBytes = 84;    // 80 of text, 4 of the number of triangles
constexpr std::size_t kTriangleBytes = 50;  // normal, three corners, two bytes of attributes

static_assert(std::endian::native == std::endian::little, "the number of triangles is copied as it stands");

void require_in_limits(std::uint64_t num_triangles, const std::string& source, const MeshLimits& limits) {
    if (num_triangles == 0) throw std::runtime_error(source + ": the file has no triangles");
    if (num_triangles > static_cast<std::uint64_t>(limits.max_triangles)) {
        throw std::runtime_error(source + ": " + std::to_string(num_triangles) +
                                 " triangles are more than the limit of " + std::to_string(limits.max_triangles));
    }
}

// Facets of a normal and three vertices, of three numbers each, in solids that end. Normals are not used, but the
// importer leaks memory where it fails on one.
std::uint64_t facets_of_text(std::string_view bytes, const std::string& source) {
    TextScanner scanner(bytes);
    const auto fail = [&](const std::string& cause) {
        throw std::runtime_error(source + ": line " + std::to_string(scanner.line_number()) + ": " + cause);
    };
    const auto require_three_numbers = [&](const std::string& what) {
        for (int axis = 0; axis < 3; ++axis) {
            if (!parse_real(scanner.word())) fail(what + " needs three numbers");
        }
    };
    std::uint64_t facets = 0;
    int corners = 0;  // of the facet at hand
    bool in_solid = false;
    bool in_facet = false;
    while (scanner.next_line()) {
        const std::string_view keyword = scanner.word();
        if (keyword == "solid" || keyword == "endsolid") {
            if (in_solid == (keyword == "solid")) fail("a solid without an end or a beginning");
            in_solid = !in_solid;
        } else if (keyword == "facet") {
            if (in_facet || scanner.word() != "normal") fail("a facet without a normal or an end");
            require_three_numbers("a normal");
            in_facet = true;
        } else if (keyword == "vertex") {
            require_three_numbers("a vertex");
            if (++corners > 3) fail("a facet with more than three vertices");
        } else if (keyword == "endfacet") {
            if (!in_facet || corners != 3) fail("a facet without a beginning or three vertices");
            in_facet = false;
            corners = 0;
            ++facets;
        } else if (!keyword.empty() && keyword != "outer" && keyword != "endloop") {
            fail("unknown keyword \"" + std::string(keyword.substr(0, 40)) + "\"");
        }
    }
    if (in_solid || in_facet || corners != 0) fail("the file ends without \"endsolid\": it is cut short");
    return facets;
}

// True if the importer and this guard see the same lines and words: it ends a line at any carriage return too, and does
// not part words at form feeds.
bool has_plain_blanks(std::string_view bytes) {
    if (bytes.find_first_of("\v\f") != bytes.npos) return false;
    for (std::size_t at = bytes.find('\r'); at != bytes.npos; at = bytes.find('\r', at + 1)) {
        if (at + 1 < bytes.size() && bytes[at + 1] != '\n') return false;
    }
    return true;
}

}  // namespace

std::uint64_t checked_stl_triangles(std::string_view bytes, const std::string& source, const MeshLimits& limits) {
    // Binary files may begin with "solid" too; their size tells them.
    std::uint32_t num_triangles = 0;
    if (bytes.size() >= kHeaderBytes) std::memcpy(&num_triangles, bytes.data() + kHeaderBytes - 4, 4);
    const std::uint64_t binary_size = kHeaderBytes + kTriangleBytes * std::uint64_t{num_triangles};
    if (bytes.size() >= kHeaderBytes && binary_size == bytes.size()) {
        require_in_limits(num_triangles, source, limits);
        return num_triangles;
    }
    if (bytes.starts_with("solid") && bytes.substr(0, 1024).find('\0') == bytes.npos) {
        if (!has_plain_blanks(bytes)) throw std::runtime_error(source + ": form feeds or single carriage returns");
        const std::uint64_t facets = facets_of_text(bytes, source);
        require_in_limits(facets, source, limits);
        return facets;
    }
    if (bytes.size() < kHeaderBytes) throw std::runtime_error(source + ": too short for an STL file");
    const std::string difference = bytes.size() < binary_size ? "cut short" : "too long";
    throw std::runtime_error(source + ": as a binary STL file of " + std::to_string(num_triangles) +
                             " triangles it would have " + std::to_string(binary_size) + " bytes, not " +
                             std::to_string(bytes.size()) + ": it is " + difference + " or not an STL file");
}

}  // namespace nearpose
