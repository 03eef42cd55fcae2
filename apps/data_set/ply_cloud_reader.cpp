#include <algorithm>
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

struct PlyType {
    std::size_t size = 0;  // [bytes]
    char kind = 'f';       // as of a CoordinateField
};

// A property behind the first list: each point has its own length from there on.
struct PlyTail {
    std::optional<PlyType> count;  // of a list
    PlyType value;
};

struct PlyHeader {
    CoordinateFields coordinates;
    std::size_t words_per_point = 0;  // before the first list; the same for the bytes
    std::size_t point_bytes = 0;
    std::vector<PlyTail> tail;
    std::uint64_t points = 0;
    std::string format;
    std::size_t data_begin = 0;  // [bytes]
};

PlyType type_named(std::string_view name, const std::string& file) {
    static const std::map<std::string_view, PlyType> kTypes = {
        {"char", {1, 'i'}},  {"uchar", {1, 'u'}},   {"int8", {1, 'i'}},   {"uint8", {1, 'u'}},
        {"short", {2, 'i'}}, {"ushort", {2, 'u'}},  {"int16", {2, 'i'}},  {"uint16", {2, 'u'}},
        {"int", {4, 'i'}},   {"uint", {4, 'u'}},    {"int32", {4, 'i'}},  {"uint32", {4, 'u'}},
        {"float", {4, 'f'}}, {"float32", {4, 'f'}}, {"double", {8, 'f'}}, {"float64", {8, 'f'}}};
    const auto found = kTypes.find(name);
    if (found == kTypes.end()) throw std::runtime_error(file + ": unknown type " + std::string(name));
    return found->second;
}

void add_property(const std::vector<std::string_view>& parts, const std::string& file, PlyHeader& header) {
    const bool is_list = parts.size() == 5 && parts[1] == "list";
    if (parts.size() != 3 && !is_list) {
        throw std::runtime_error(file + ": a property of the vertices must be a type and a name");
    }
    if (is_list) {
        const PlyType count = type_named(parts[2], file);
        if (count.kind == 'f') throw std::runtime_error(file + ": the length of a list must be a whole number");
        header.tail.push_back({count, type_named(parts[3], file)});
        return;
    }
    const PlyType type = type_named(parts[1], file);
    const std::size_t axis = parts[2] == "x" ? 0 : parts[2] == "y" ? 1 : parts[2] == "z" ? 2 : 3;
    if (axis < 3) {
        if (header.coordinates[axis].word >= 0) {
            throw std::runtime_error(file + ": " + std::string(parts[2]) + " stands twice");
        }
        if (!header.tail.empty()) throw std::runtime_error(file + ": a list stands before x, y and z");
        header.coordinates[axis] = {static_cast<int>(header.words_per_point), header.point_bytes, type.size, type.kind};
    }
    if (!header.tail.empty()) {
        header.tail.push_back({std::nullopt, type});
        return;
    }
    ++header.words_per_point;
    header.point_bytes += type.size;
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

// The bytes of the properties behind the first list, of the point whose they are at the beginning of `data`.
std::size_t tail_bytes(std::string_view data, const PlyHeader& header, bool swap, const std::string& file) {
    std::size_t bytes = 0;
    for (const PlyTail& property : header.tail) {
        std::uint64_t values = 1;
        if (property.count) {
            if (data.size() < bytes + property.count->size) throw std::runtime_error(file + ": cut short in a list");
            const double length = read_number(data.data() + bytes, property.count->size, property.count->kind, swap);
            if (length < 0.0) throw std::runtime_error(file + ": a list has a negative length");
            values = static_cast<std::uint64_t>(length);
            bytes += property.count->size;
        }
        if (values * property.value.size > data.size() - std::min(bytes, data.size())) {
            throw std::runtime_error(file + ": cut short in a list");
        }
        bytes += values * property.value.size;
    }
    return bytes;
}

}  // namespace

CloudFile read_ply_cloud(std::string_view bytes, const std::string& file) {
    const PlyHeader header = read_ply_header(bytes, file);
    std::string_view data = bytes.substr(header.data_begin);
    CloudFile cloud{static_cast<int>(header.points), 1, {}};
    if (header.format == "ascii") {
        cloud.points_in_camera = read_text_points(data, header.points, header.words_per_point, header.coordinates, file,
                                                  !header.tail.empty());
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
    for (Eigen::Vector3f& point : cloud.points_in_camera) {
        if (data.size() < header.point_bytes) throw std::runtime_error(file + ": cut short: too few points");
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const CoordinateField& field = header.coordinates[axis];
            point[static_cast<int>(axis)] = read_coordinate(data.data() + field.offset, field, swap);
        }
        data.remove_prefix(header.point_bytes);
        data.remove_prefix(tail_bytes(data, header, swap, file));
    }
    return cloud;
}

}  // namespace nearpose::data_set
