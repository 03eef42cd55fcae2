// What the readers of .pcd and .ply clouds share. Private to them.
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

// Where a coordinate stands within a point of a binary file; float32 or float64.
struct CoordinateField {
    int word = -1;           // its place among the point's values, for text files
    std::size_t offset = 0;  // [bytes]
    std::size_t size = 0;    // 4 or 8 [bytes]
};
using CoordinateFields = std::array<CoordinateField, 3>;  // x, y, z

// `value` points to `field.size` bytes.
inline float read_coordinate(const char* value, std::size_t size, bool swap_bytes) {
    std::array<char, 8> bytes{};
    for (std::size_t i = 0; i < size; ++i) bytes[i] = value[swap_bytes ? size - 1 - i : i];
    if (size == 4) {
        float number = 0.0F;
        std::memcpy(&number, bytes.data(), sizeof number);
        return number;
    }
    double number = 0.0;
    std::memcpy(&number, bytes.data(), sizeof number);
    return static_cast<float>(number);
}

// `count` points from the text after a header: lines of `words_per_point` numbers. Throws std::runtime_error.
std::vector<Eigen::Vector3f> read_text_points(std::string_view text, std::uint64_t count, std::size_t words_per_point,
                                              const CoordinateFields& fields, const std::string& file);

// `bytes` are the file's, `file` its name for messages. Points are as they stand in the file, not finite ones included.
CloudFile read_pcd(std::string_view bytes, const std::string& file);
CloudFile read_ply_cloud(std::string_view bytes, const std::string& file);

// The next line from `position` on, without its end; moves `position` behind it. Throws where the text ends before.
std::string_view header_line(std::string_view bytes, std::size_t& position, const std::string& file);

}  // namespace nearpose::data_set
