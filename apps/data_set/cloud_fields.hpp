// What the readers of clouds share. Private to them.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

#include "apps/data_set/point_cloud_file.hpp"

namespace nearpose::data_set {

// More than any depth camera's image, and 1.2 GB of points at most.
inline constexpr std::uint64_t kMaxCloudPoints = 100'000'000;

// Where a coordinate stands within a point of a binary file.
struct CoordinateField {
    int word = -1;           // its place among the point's values, for text files
    std::size_t offset = 0;  // [bytes]
    std::size_t size = 0;    // 1, 2, 4 or 8 [bytes]
    char kind = 'f';         // floating point, 'i': whole, 'u': whole without a sign
};
using CoordinateFields = std::array<CoordinateField, 3>;  // x, y, z

template <typename Number>
double number_from(const std::array<char, 8>& bytes) {
    Number number{};
    std::memcpy(&number, bytes.data(), sizeof number);
    return static_cast<double>(number);
}

// `value` points to `size` bytes of a number of the kind; floating point has 4 or 8.
inline double read_number(const char* value, std::size_t size, char kind, bool swap_bytes) {
    std::array<char, 8> bytes{};
    for (std::size_t i = 0; i < size; ++i) bytes[i] = value[swap_bytes ? size - 1 - i : i];
    if (kind == 'f') return size == 4 ? number_from<float>(bytes) : number_from<double>(bytes);
    const bool is_signed = kind == 'i';
    if (size == 1) return is_signed ? number_from<std::int8_t>(bytes) : number_from<std::uint8_t>(bytes);
    if (size == 2) return is_signed ? number_from<std::int16_t>(bytes) : number_from<std::uint16_t>(bytes);
    return is_signed ? number_from<std::int32_t>(bytes) : number_from<std::uint32_t>(bytes);
}

inline float read_coordinate(const char* value, const CoordinateField& field, bool swap_bytes) {
    return static_cast<float>(read_number(value, field.size, field.kind, swap_bytes));
}

// `count` points from the text after a header: lines of `words_per_point` numbers, or of at least as many where
// `more_words`. Throws std::runtime_error.
std::vector<Eigen::Vector3f> read_text_points(std::string_view text, std::uint64_t count, std::size_t words_per_point,
                                              const CoordinateFields& fields, const std::string& file,
                                              bool more_words = false);

// `bytes` are the file's, `file` its name for messages. Points are as they stand in the file, not finite ones included.
CloudFile read_pcd(std::string_view bytes, const std::string& file);
CloudFile read_ply_cloud(std::string_view bytes, const std::string& file);
// Lines of x y z and anything more, apart by spaces, tabs, commas or semicolons; .xyz and .pts. A first line of words,
// or of the number of points alone, and lines that begin with # are passed over.
CloudFile read_text_cloud(std::string_view bytes, const std::string& file);

// The next line from `position` on, without its end; moves `position` behind it. Throws where the text ends before.
std::string_view header_line(std::string_view bytes, std::size_t& position, const std::string& file);

}  // namespace nearpose::data_set
