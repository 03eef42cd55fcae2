// Strict: what a file declares must be there, no more and no less, row by row. Blanks and colours of faces may be more.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "raycast/mesh_files/face_writer.hpp"
#include "raycast/mesh_files/ply_header.hpp"
#include "raycast/mesh_files/readers.hpp"
#include "raycast/mesh_files/text_scanner.hpp"

namespace nearpose {
namespace {

// The values after the header, one by one, from text or binary.
class PlyBody {
  public:
    PlyBody(std::string_view bytes, const PlyHeader& header, std::string source)
        : format_(header.format),
          bytes_(bytes.substr(header.size)),
          text_(bytes_),
          header_lines_(header.num_lines),
          source_(std::move(source)) {}

    [[noreturn]] void fail(const std::string& cause) const {
        const std::string place = format_ == PlyFormat::kText
                                      ? "line " + std::to_string(header_lines_ + text_.line_number())
                                      : "byte " + std::to_string(position_) + " after the header";
        throw std::runtime_error(source_ + ": " + place + ": " + cause);
    }

    std::size_t bytes_left() const {
        return bytes_.size() - (format_ == PlyFormat::kText ? text_.position() : position_);
    }
    // The fewest bytes that a value can take: in text a digit and what parts it from the next.
    std::size_t min_size(PlyType type) const { return format_ == PlyFormat::kText ? 2 : size_of(type); }

    // In text each row of an element is a line of its own; rows of a broken file cannot run into each other.
    void begin_row() {
        if (format_ != PlyFormat::kText) return;
        do {
            if (!text_.next_line()) fail("the file is cut short");
            pending_ = text_.word();
        } while (pending_.empty());
    }
    void end_row() {
        if (format_ == PlyFormat::kText && !next_word().empty()) fail("more values than the header says");
    }
    // The same, but in text a colour may follow that the header does not mention: three or four numbers of a byte each.
    void end_face() {
        if (format_ != PlyFormat::kText) return;
        int num_values = 0;
        bool is_colour = true;
        for (std::string_view word = next_word(); !word.empty(); word = next_word(), ++num_values) {
            const std::optional<std::int64_t> value = parse_integer(word);
            is_colour = is_colour && value && *value >= 0 && *value <= 255;
        }
        is_colour = is_colour && (num_values == 3 || num_values == 4);
        if (num_values > 0 && !is_colour) fail("more values than the header says");
    }

    double scalar(PlyType type) {
        if (format_ == PlyFormat::kText) {
            const std::string_view word = next_word();
            if (word.empty()) fail("fewer values than the header says");
            const std::optional<double> value = parse_real(word);
            if (!value) fail("\"" + std::string(word.substr(0, 40)) + "\" is not a number");
            return *value;
        }
        return binary(type);
    }

    // Length of a list, checked against the bytes that are left.
    std::size_t length(const PlyProperty& property) {
        const double count = scalar(property.count_type);
        if (!(count >= 0.0 && count == std::floor(count))) fail("the length of a list is not 0 or more");
        // The last value may lack its separator.
        if (count * static_cast<double>(min_size(property.type)) > static_cast<double>(row_left() + 1)) {
            fail("a list is longer than the rest of the file: the file is cut short or broken");
        }
        return static_cast<std::size_t>(count);
    }

    void skip(const PlyProperty& property) {
        const std::size_t count = property.is_list ? length(property) : 1;
        for (std::size_t i = 0; i < count; ++i) scalar(property.type);
    }

    void require_end() {
        while (format_ == PlyFormat::kText && text_.next_line()) {
            if (!text_.word().empty()) fail("more rows than the header says");
        }
        if (format_ != PlyFormat::kText && !is_padding(bytes_.substr(position_))) {
            fail(std::to_string(bytes_left()) + " bytes more than the header says");
        }
    }

  private:
    std::string_view next_word() {
        return pending_.empty() ? text_.word() : std::exchange(pending_, std::string_view());
    }
    std::size_t row_left() const { return format_ == PlyFormat::kText ? bytes_.size() : bytes_left(); }

    double binary(PlyType type) {
        const std::size_t size = size_of(type);
        if (bytes_left() < size) fail("the file is cut short");
        std::array<char, 8> raw{};
        std::memcpy(raw.data(), bytes_.data() + position_, size);
        position_ += size;
        constexpr bool kLittleHere = std::endian::native == std::endian::little;
        if ((format_ == PlyFormat::kLittleEndian) != kLittleHere)
            std::reverse(raw.begin(), raw.begin() + std::min(size, raw.size()));
        switch (type) {
            case PlyType::kInt8:
                return as<std::int8_t>(raw);
            case PlyType::kUint8:
                return as<std::uint8_t>(raw);
            case PlyType::kInt16:
                return as<std::int16_t>(raw);
            case PlyType::kUint16:
                return as<std::uint16_t>(raw);
            case PlyType::kInt32:
                return as<std::int32_t>(raw);
            case PlyType::kUint32:
                return as<std::uint32_t>(raw);
            case PlyType::kFloat:
                return static_cast<double>(as<float>(raw));
            case PlyType::kDouble:
                return as<double>(raw);
        }
        return 0.0;
    }
    template <typename T>
    static T as(const std::array<char, 8>& raw) {
        T value;
        std::memcpy(&value, raw.data(), sizeof(T));
        return value;
    }

    PlyFormat format_;
    std::string_view bytes_;
    TextScanner text_;
    std::string_view pending_;  // first word of the row
    std::size_t position_ = 0;  // binary
    std::int64_t header_lines_;
    std::string source_;
};

// A count that the rest of the file cannot hold is refused before anything is allocated for it.
void require_room(const PlyElement& element, const PlyBody& body) {
    std::size_t row = 0;
    for (const PlyProperty& property : element.properties) {
        row += body.min_size(property.is_list ? property.count_type : property.type);
    }
    if (row > 0 && element.count > (body.bytes_left() + 1) / row) {
        body.fail(std::to_string(element.count) + " rows of \"" + element.name + "\" are declared, but only " +
                  std::to_string(body.bytes_left()) + " bytes follow: the file is cut short or broken");
    }
}

void read_vertices(const PlyElement& element, PlyBody& body, const MeshLimits& limits, Mesh& mesh) {
    constexpr std::array<std::string_view, 6> kNames{"x", "y", "z", "nx", "ny", "nz"};
    std::array<int, 6> place{};
    for (std::size_t k = 0; k < 6; ++k) {
        place[k] = element.find(kNames[k]);
        const bool usable = place[k] >= 0 && !element.properties[static_cast<std::size_t>(place[k])].is_list;
        if (!usable && k < 3) body.fail("vertices have no property \"" + std::string(kNames[k]) + "\"");
        if (!usable) place[k] = -1;
    }
    if (element.count > 3 * static_cast<std::uint64_t>(limits.max_triangles)) {
        body.fail(std::to_string(element.count) + " vertices are more than the limit of " +
                  std::to_string(3 * limits.max_triangles));
    }
    const bool has_normals = place[3] >= 0 && place[4] >= 0 && place[5] >= 0;
    mesh.vertices_in_object.reserve(element.count);
    for (std::uint64_t row = 0; row < element.count; ++row) {
        std::array<float, 6> value{};
        body.begin_row();
        for (std::size_t p = 0; p < element.properties.size(); ++p) {
            const auto slot = std::find(place.begin(), place.end(), static_cast<int>(p)) - place.begin();
            if (slot < 6) {
                value[static_cast<std::size_t>(slot)] = static_cast<float>(body.scalar(element.properties[p].type));
            } else {
                body.skip(element.properties[p]);
            }
        }
        body.end_row();
        mesh.vertices_in_object.emplace_back(value[0], value[1], value[2]);
        if (has_normals) mesh.vertex_normals_in_object.emplace_back(value[3], value[4], value[5]);
    }
}

void read_faces(const PlyElement& element, std::uint64_t num_vertices, PlyBody& body, FaceWriter& faces) {
    if (element.count == 0) return;
    const int place = std::max(element.find("vertex_indices"), element.find("vertex_index"));
    if (place < 0 || !element.properties[static_cast<std::size_t>(place)].is_list) {
        body.fail("faces have no list \"vertex_indices\"");
    }
    std::vector<int> corners;
    for (std::uint64_t row = 0; row < element.count; ++row) {
        body.begin_row();
        for (std::size_t p = 0; p < element.properties.size(); ++p) {
            const PlyProperty& property = element.properties[p];
            if (static_cast<int>(p) != place) {
                body.skip(property);
                continue;
            }
            corners.resize(body.length(property));
            for (int& corner : corners) {
                const double index = body.scalar(property.type);
                const bool exists = index >= 0.0 && index < static_cast<double>(num_vertices);
                corner = exists && index == std::floor(index) ? static_cast<int>(index) : -1;
            }
            faces.add(corners);
        }
        body.end_face();
    }
}

}  // namespace

Mesh read_ply(std::string_view bytes, const std::string& source, const MeshLimits& limits, MeshRepair& repair) {
    const PlyHeader header = parse_ply_header(bytes, source);
    PlyBody body(bytes, header, source);
    std::uint64_t num_vertices = 0;
    for (const PlyElement& element : header.elements) {
        if (element.name == "vertex") num_vertices = element.count;
        // A mesh stored in strips would be taken for a cloud.
        if (element.name == "tristrips") body.fail("triangle strips are not supported; export faces");
    }
    if (num_vertices == 0) body.fail("the file has no vertices");

    Mesh mesh;
    FaceWriter faces(source, limits, mesh, repair);
    for (const PlyElement& element : header.elements) {
        require_room(element, body);
        if (element.name == "vertex") {
            read_vertices(element, body, limits, mesh);
        } else if (element.name == "face") {
            read_faces(element, num_vertices, body, faces);
            if (element.count > 0 && mesh.triangles.empty()) body.fail("none of the faces has three corners");
        } else {
            for (std::uint64_t row = 0; row < element.count; ++row) {
                body.begin_row();
                for (const PlyProperty& property : element.properties) body.skip(property);
                body.end_row();
            }
        }
    }
    body.require_end();
    faces.finish();
    if (mesh.is_cloud() && num_vertices > static_cast<std::uint64_t>(limits.max_triangles)) {
        body.fail(std::to_string(num_vertices) + " points are more than the limit of " +
                  std::to_string(limits.max_triangles));
    }
    return mesh;
}

}  // namespace nearpose
