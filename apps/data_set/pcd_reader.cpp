#include <liblzf/lzf.h>

#include <limits>
#include <map>
#include <optional>
#include <stdexcept>
#include <vector>

#include "apps/base/number_text.hpp"
#include "apps/base/text_split.hpp"
#include "apps/data_set/cloud_fields.hpp"

namespace nearpose::data_set {
namespace {

constexpr std::size_t kMaxFields = 256;
constexpr std::uint64_t kMaxFieldCount = 4096;  // values of one field, as of a feature histogram
constexpr std::size_t kMaxPcdHeaderLines = 100;

// LZF makes at most 264 bytes out of 3.
constexpr std::uint64_t kMaxLzfRatio = 88;

struct PcdHeader {
    CoordinateFields coordinates;
    std::size_t words_per_point = 0;
    std::size_t point_bytes = 0;
    std::uint64_t width = 0, height = 0;
    std::string encoding;
    std::size_t data_begin = 0;  // [bytes]
    std::uint64_t points() const { return width * height; }
};

using Entries = std::map<std::string, std::vector<std::string>, std::less<>>;

// The header's lines by their first word, up to and with DATA.
Entries read_entries(std::string_view bytes, std::size_t& position, const std::string& file) {
    Entries entries;
    for (std::size_t number = 0; number < kMaxPcdHeaderLines; ++number) {
        const std::vector<std::string_view> parts = words(header_line(bytes, position, file));
        if (parts.empty() || parts[0].front() == '#') continue;
        const auto [entry, is_new] = entries.try_emplace(std::string(parts[0]), parts.begin() + 1, parts.end());
        if (!is_new) throw std::runtime_error(file + ": " + entry->first + " stands twice in the header");
        if (entry->first == "DATA") return entries;
    }
    throw std::runtime_error(file + ": the header does not end");
}

const std::vector<std::string>& entry_of(const Entries& entries, std::string_view name, const std::string& file) {
    const auto found = entries.find(name);
    if (found == entries.end() || found->second.empty()) {
        throw std::runtime_error(file + ": the header lacks " + std::string(name));
    }
    return found->second;
}

std::uint64_t count_of(const std::string& text, std::uint64_t maximum, const std::string& what,
                       const std::string& file) {
    const std::optional<std::int64_t> value = parse_integer(text);
    if (!value || *value < 0 || static_cast<std::uint64_t>(*value) > maximum) {
        throw std::runtime_error(file + ": " + what + " is " + text + ", but must be in 0.." + std::to_string(maximum));
    }
    return static_cast<std::uint64_t>(*value);
}

void read_fields(const Entries& entries, const std::string& file, PcdHeader& header) {
    // Versions before 0.7 call them COLUMNS, and need not say that all are one float32.
    const std::vector<std::string>& names = entry_of(entries, entries.contains("COLUMNS") ? "COLUMNS" : "FIELDS", file);
    const auto given = [&](const char* name, const char* usual) {
        return entries.contains(name) ? entry_of(entries, name, file) : std::vector<std::string>(names.size(), usual);
    };
    const std::vector<std::string> sizes = given("SIZE", "4"), types = given("TYPE", "F"), counts = given("COUNT", "1");
    if (names.size() > kMaxFields || sizes.size() != names.size() || types.size() != names.size() ||
        counts.size() != names.size()) {
        throw std::runtime_error(file + ": FIELDS, SIZE, TYPE and COUNT differ in number");
    }
    for (std::size_t i = 0; i < names.size(); ++i) {
        const std::size_t size = count_of(sizes[i], 8, "SIZE", file);
        const std::size_t count = count_of(counts[i], kMaxFieldCount, "COUNT", file);
        const std::size_t axis = names[i] == "x" ? 0 : names[i] == "y" ? 1 : names[i] == "z" ? 2 : 3;
        if (axis < 3) {
            if (types[i] != "F" || (size != 4 && size != 8) || count != 1) {
                throw std::runtime_error(file + ": " + names[i] + " must be one float32 or float64");
            }
            if (header.coordinates[axis].word >= 0) throw std::runtime_error(file + ": " + names[i] + " stands twice");
            header.coordinates[axis] = {static_cast<int>(header.words_per_point), header.point_bytes, size, 'f'};
        }
        header.words_per_point += count;
        header.point_bytes += size * count;
    }
    for (const CoordinateField& field : header.coordinates) {
        if (field.word < 0) throw std::runtime_error(file + ": the fields x, y and z are not all there");
    }
}

PcdHeader read_pcd_header(std::string_view bytes, const std::string& file) {
    PcdHeader header;
    const Entries entries = read_entries(bytes, header.data_begin, file);
    read_fields(entries, file, header);
    const bool has_width = entries.contains("WIDTH") || !entries.contains("POINTS");
    header.width = count_of(entry_of(entries, has_width ? "WIDTH" : "POINTS", file)[0], kMaxCloudPoints, "WIDTH", file);
    header.height = has_width ? count_of(entry_of(entries, "HEIGHT", file)[0], kMaxCloudPoints, "HEIGHT", file) : 1;
    if (header.points() > kMaxCloudPoints) throw std::runtime_error(file + ": claims too many points");
    if (entries.contains("POINTS")) {
        const std::uint64_t points = count_of(entry_of(entries, "POINTS", file)[0], kMaxCloudPoints, "POINTS", file);
        if (points != header.points()) throw std::runtime_error(file + ": POINTS is not WIDTH times HEIGHT");
    }
    header.encoding = entry_of(entries, "DATA", file)[0];
    return header;
}

// `point_stride[a]` bytes lie between coordinate a of one point and that of the next, the first at `begin[a]`.
std::vector<Eigen::Vector3f> gather(std::string_view data, const PcdHeader& header,
                                    const std::array<std::uint64_t, 3>& begin,
                                    const std::array<std::uint64_t, 3>& point_stride) {
    constexpr bool kSwap = std::endian::native == std::endian::big;  // the format is that of the writer: little endian
    std::vector<Eigen::Vector3f> points(header.points());
    for (std::size_t i = 0; i < points.size(); ++i) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            points[i][static_cast<int>(axis)] =
                read_coordinate(data.data() + begin[axis] + i * point_stride[axis], header.coordinates[axis], kSwap);
        }
    }
    return points;
}

std::vector<Eigen::Vector3f> read_binary(std::string_view data, const PcdHeader& header, const std::string& file) {
    if (data.size() < header.points() * header.point_bytes) {
        throw std::runtime_error(file + ": cut short: " + std::to_string(data.size()) + " bytes of data instead of " +
                                 std::to_string(header.points() * header.point_bytes));
    }
    const CoordinateFields& c = header.coordinates;
    return gather(data, header, {c[0].offset, c[1].offset, c[2].offset},
                  {header.point_bytes, header.point_bytes, header.point_bytes});
}

// Two sizes, then LZF data in which each field of all points stands together.
std::vector<Eigen::Vector3f> read_compressed(std::string_view data, const PcdHeader& header, const std::string& file) {
    if (header.points() == 0) return {};
    constexpr std::size_t kSizes = 8;
    const auto size_at = [&](std::size_t at) {
        std::uint32_t value = 0;
        for (std::size_t i = 4; i-- > 0;) value = value << 8 | static_cast<unsigned char>(data[at + i]);
        return value;
    };
    if (data.size() < kSizes) throw std::runtime_error(file + ": cut short: no compressed data");
    const std::uint32_t packed = size_at(0);
    const std::uint32_t unpacked = size_at(4);
    if (packed > data.size() - kSizes) throw std::runtime_error(file + ": cut short: too little compressed data");
    if (unpacked != header.points() * header.point_bytes || unpacked > kMaxLzfRatio * packed + kMaxLzfRatio) {
        throw std::runtime_error(file + ": the compressed data do not have the size of the points");
    }
    std::string raw(unpacked, '\0');
    if (lzf_decompress(data.data() + kSizes, packed, raw.data(), unpacked) != unpacked) {
        throw std::runtime_error(file + ": the compressed data are damaged");
    }
    const CoordinateFields& c = header.coordinates;
    const std::uint64_t n = header.points();
    return gather(raw, header, {c[0].offset * n, c[1].offset * n, c[2].offset * n}, {c[0].size, c[1].size, c[2].size});
}

}  // namespace

CloudFile read_pcd(std::string_view bytes, const std::string& file) {
    const PcdHeader header = read_pcd_header(bytes, file);
    const std::string_view data = bytes.substr(header.data_begin);
    CloudFile cloud{static_cast<int>(header.width), static_cast<int>(header.height), {}};
    if (header.encoding == "ascii") {
        cloud.points_in_camera =
            read_text_points(data, header.points(), header.words_per_point, header.coordinates, file);
    } else if (header.encoding == "binary") {
        cloud.points_in_camera = read_binary(data, header, file);
    } else if (header.encoding == "binary_compressed") {
        cloud.points_in_camera = read_compressed(data, header, file);
    } else {
        throw std::runtime_error(file + ": DATA is " + header.encoding + ", but must be ascii, binary or " +
                                 "binary_compressed");
    }
    return cloud;
}

}  // namespace nearpose::data_set
