// The header of a PLY file.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace nearpose {

enum class PlyFormat { kText, kLittleEndian, kBigEndian };
enum class PlyType { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat, kDouble };

std::size_t size_of(PlyType type);  // [bytes]

struct PlyProperty {
    std::string name;
    PlyType type = PlyType::kFloat;  // of the value, or of each value of a list
    bool is_list = false;
    PlyType count_type = PlyType::kUint8;  // of a list's length
};

struct PlyElement {
    std::string name;
    std::uint64_t count = 0;
    std::vector<PlyProperty> properties;

    // Index of the property called `property`, -1 if there is none.
    int find(std::string_view property) const;
};

struct PlyHeader {
    PlyFormat format = PlyFormat::kText;
    std::vector<PlyElement> elements;
    std::size_t size = 0;  // [bytes], up to and with the end of the line end_header
    std::int64_t num_lines = 0;
};

// Throws std::runtime_error that names `source`, the line and the cause for everything that is not the format's.
PlyHeader parse_ply_header(std::string_view bytes, const std::string& source);

}  // namespace nearpose
