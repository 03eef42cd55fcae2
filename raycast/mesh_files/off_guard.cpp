#include <algorithm>
#include <stdexcept>
#include <utility>

#include "raycast/mesh_files/import_guards.hpp"
#include "raycast/mesh_files/text_scanner.hpp"

namespace nearpose {
namespace {

constexpr std::size_t kMaxLineBytes = 1000;  // the importer copies lines into 4096 bytes without a look at their length
constexpr std::int64_t kMaxCorners = 9;      // the importer leaves out faces of more

class OffChecker {
  public:
    OffChecker(std::string_view bytes, std::string source)
        : bytes_(bytes), scanner_(bytes), source_(std::move(source)) {}

    std::uint64_t run(const MeshLimits& limits) {
        require_short_lines();
        // Other kinds (NOFF, STOFF, 4OFF, OFF BINARY) have other columns; a COFF has colours after the coordinates.
        const std::string_view magic = next_row();
        if (magic != "OFF" && magic != "COFF") fail("the first word is not OFF or COFF");
        const std::string_view beside = scanner_.word();
        const std::int64_t num_vertices = count(beside.empty() ? next_row() : beside);
        const std::int64_t num_faces = count(scanner_.word());
        if (num_vertices == 0 || num_faces == 0) fail("the file has no vertices or no faces");
        if (num_vertices > 3 * limits.max_triangles) {
            fail("more vertices than the limit of " + std::to_string(3 * limits.max_triangles));
        }
        for (std::int64_t v = 0; v < num_vertices; ++v) {
            const bool three_numbers =
                parse_real(next_row()) && parse_real(scanner_.word()) && parse_real(scanner_.word());
            if (!three_numbers) fail("a vertex needs three numbers");
        }
        std::uint64_t triangles = 0;
        for (std::int64_t f = 0; f < num_faces; ++f) {
            triangles += triangles_of_face(next_row(), num_vertices);
            if (triangles > static_cast<std::uint64_t>(limits.max_triangles)) {
                fail("more triangles than the limit of " + std::to_string(limits.max_triangles));
            }
        }
        while (scanner_.next_line()) {
            const std::string_view word = scanner_.word();
            if (!word.empty() && !word.starts_with('#')) fail("more rows than the header says");
        }
        return triangles;
    }

  private:
    [[noreturn]] void fail(const std::string& cause) const {
        throw std::runtime_error(source_ + ": line " + std::to_string(scanner_.line_number()) + ": " + cause);
    }

    void require_short_lines() const {
        std::size_t begin = 0;
        for (std::size_t end = 0; begin < bytes_.size(); begin = end + 1) {
            end = std::min(bytes_.find_first_of("\r\n", begin), bytes_.size());
            if (end - begin > kMaxLineBytes) {
                throw std::runtime_error(source_ + ": a line is longer than " + std::to_string(kMaxLineBytes) +
                                         " bytes");
            }
        }
        if (bytes_.find('\0') != bytes_.npos) throw std::runtime_error(source_ + ": not a text file; export text OFF");
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

    std::uint64_t triangles_of_face(std::string_view first_word, std::int64_t num_vertices) {
        const std::optional<std::int64_t> corners = parse_integer(first_word);
        if (!corners || *corners < 1 || *corners > kMaxCorners) {
            fail("a face has not 1 to " + std::to_string(kMaxCorners) + " corners; export triangles");
        }
        for (std::int64_t k = 0; k < *corners; ++k) {
            const std::optional<std::int64_t> index = parse_integer(scanner_.word());
            if (!index || *index < 0 || *index >= num_vertices) fail("a corner of a face does not exist");
        }
        return *corners < 3 ? 0 : static_cast<std::uint64_t>(*corners - 2);
    }

    std::string_view bytes_;
    TextScanner scanner_;
    std::string source_;
};

}  // namespace

std::uint64_t checked_off_triangles(std::string_view bytes, const std::string& source, const MeshLimits& limits) {
    return OffChecker(bytes, source).run(limits);
}

}  // namespace nearpose
