#include <map>
#include <optional>
#include <stdexcept>
#include <vector>

#include "apps/base/number_text.hpp"
#include "apps/base/text_split.hpp"
#include "apps/data_set/cloud_fields.hpp"

namespace nearpose::data_set {
namespace {

constexpr std::size_t kMaxPlyHeaderLines = 1000;

struct PlyHeader {
    CoordinateFields coordinates;
    std::size_t words_per_point = 0;
    std::size_t point_bytes = 0;
    std::uint64_t points = 0;
    std::string format;
    std::size_t data_begin = 0;  // [bytes]
};

std::size_t size_of_type(std::string_view type, const std::string& file) {
    static const std::map<std::string_view, std::size_t> kSizes = {
        {"char", 1},  {"uchar", 1},   {"int8", 1},   {"uint8", 1},  {"short", 2}, {"ushort", 2},
        {"int16", 2}, {"uint16", 2},  {"int", 4},    {"uint", 4},   {"int32", 4}, {"uint32", 4},
        {"float", 4}, {"float32", 4}, {"double", 8}, {"float64", 8}};
    const auto found = kSizes.find(type);
    if (found == kSizes.end()) throw std::runtime_error(file + ": unknown type " + std::string(type));
    return found->second;
}

void add_property(const std::vector<std::string_view>& parts, const std::string& file, PlyHeader& header) {
    if (parts.size() != 3) throw std::runtime_error(file + ": a property of the vertices must be a type and a name");
    const std::size_t size = size_of_type(parts[1], file);
    const std::size_t axis = parts[2] == "x" ? 0 : parts[2] == "y" ? 1 : parts[2] == "z" ? 2 : 3;
    if (axis < 3) {
        const bool is_float = parts[1].starts_with("float") || parts[1].starts_with("double");
        if (!is_float) throw std::runtime_error(file + ": " + std::string(parts[2]) + " must be a float or a double");
        if (header.coordinates[axis].word >= 0) {
            throw std::runtime_error(file + ": " + std::string(parts[2]) + " stands twice");
        }
        header.coordinates[axis] = {static_cast<int>(header.words_per_point), header.point_bytes, size};
    }
    ++header.words_per_point;
    header.point_bytes += size;
}

std::uint64_t vertex_count(std::string_view text, const std::string& file) {
    const std::optional<std::int64_t> count = parse_integer(text);
    if (!count || *count < 0 || static_cast<std::uint64_t>(*count) > kMaxCloudPoints) {
        throw std::runtime_error(file + ": claims " + std::string(text) + " points");
    }
    return static_cast<std::uint64_t>(*count);
}

// The vertices must come first, as every writer has them; what follows them (faces) is left alone.
PlyHeader read_ply_header(std::string_view bytes, const std::string& file) {
    PlyHeader header;
    if (header_line(bytes, header.data_begin, file) != "ply") throw std::runtime_error(file + ": is not a PLY file");
    int elements = 0;
    for (std::size_t number = 0; number < kMaxPlyHeaderLines; ++number) {
        const std::vector<std::string_view> parts = words(header_line(bytes, header.data_begin, file));
        if (parts.empty() || parts[0] == "comment" || parts[0] == "obj_info") continue;
        if (parts[0] == "end_header") {
            for (const CoordinateField& field : header.coordinates) {
                if (field.word < 0) throw std::runtime_error(file + ": the properties x, y and z are not all there");
            }
            return header;
        }
        if (parts[0] == "format" && parts.size() == 3 && header.format.empty()) {
            header.format = parts[1];
        } else if (parts[0] == "element" && parts.size() == 3) {
            if (++elements == 1 && parts[1] != "vertex") {
                throw std::runtime_error(file + ": the vertices must be the first element");
            }
            if (elements == 1) header.points = vertex_count(parts[2], file);
        } else if (parts[0] == "property" && elements > 0) {
            if (elements == 1) add_property(parts, file, header);
        } else {
            throw std::runtime_error(file + ": the header has a line that is not understood: " + std::string(parts[0]));
        }
    }
    throw std::runtime_error(file + ": the header does not end");
}

}  // namespace

CloudFile read_ply_cloud(std::string_view bytes, const std::string& file) {
    const PlyHeader header = read_ply_header(bytes, file);
    const std::string_view data = bytes.substr(header.data_begin);
    CloudFile cloud{static_cast<int>(header.points), 1, {}};
    if (header.format == "ascii") {
        cloud.points_in_camera =
            read_text_points(data, header.points, header.words_per_point, header.coordinates, file);
        return cloud;
    }
    const bool is_big = header.format == "binary_big_endian";
    if (!is_big && header.format != "binary_little_endian") throw std::runtime_error(file + ": unknown PLY format");
    if (data.size() < header.points * header.point_bytes) {
        throw std::runtime_error(file + ": cut short: " + std::to_string(data.size()) + " bytes of data instead of " +
                                 std::to_string(header.points * header.point_bytes));
    }
    const bool swap = is_big != (std::endian::native == std::endian::big);
    cloud.points_in_camera.resize(header.points);
    for (std::size_t i = 0; i < cloud.points_in_camera.size(); ++i) {
        const char* point = data.data() + i * header.point_bytes;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const CoordinateField& field = header.coordinates[axis];
            cloud.points_in_camera[i][static_cast<int>(axis)] = read_coordinate(point + field.offset, field.size, swap);
        }
    }
    return cloud;
}

}  // namespace nearpose::data_set
