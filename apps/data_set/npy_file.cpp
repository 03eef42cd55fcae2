#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <map>
#include <optional>
#include <string_view>
#include <vector>

#include "apps/base/file_io.hpp"
#include "apps/base/number_text.hpp"
#include "apps/data_set/depth_readers.hpp"

namespace nearpose::data_set {
namespace {

constexpr std::size_t kMaxHeaderBytes = 65536;

struct NpyHeader {
    char kind = 0;          // 'u', 'i' or 'f'
    std::size_t bytes = 0;  // of a number
    bool swap = false;
    bool columns_first = false;
    std::vector<std::int64_t> shape;
    std::size_t data_begin = 0;  // [bytes]
};

// What stands after 'key': in the header, which is the text of a Python dictionary.
std::string_view value_of(std::string_view header, std::string_view key, const DepthRequest& request) {
    const std::size_t found = header.find("'" + std::string(key) + "'");
    const std::size_t colon = found == header.npos ? found : header.find(':', found);
    if (colon == header.npos) throw request.error("the NPY header lacks " + std::string(key));
    const std::size_t begin = header.find_first_not_of(" ", colon + 1);
    return begin == header.npos ? std::string_view() : header.substr(begin);
}

void read_type(std::string_view text, const DepthRequest& request, NpyHeader& header) {
    const std::size_t end = text.empty() ? text.npos : text.find('\'', 1);
    const std::string_view type = end == text.npos ? text.substr(0, 20) : text.substr(1, end - 1);
    static const std::map<std::string_view, std::size_t> kTypes = {{"u1", 1}, {"u2", 2}, {"i2", 2}, {"u4", 4},
                                                                   {"i4", 4}, {"f4", 4}, {"f8", 8}};
    const auto found = type.size() == 3 ? kTypes.find(type.substr(1)) : kTypes.end();
    if (found == kTypes.end() || std::string_view("<>|=").find(type[0]) == std::string_view::npos) {
        throw request.error("holds numbers of the type " + std::string(type) +
                            "; depth must be uint16, int32, float32 or float64");
    }
    header.kind = type[1];
    header.bytes = found->second;
    const bool is_big = type[0] == '>' || (type[0] == '=' && std::endian::native == std::endian::big);
    header.swap = header.bytes > 1 && is_big != (std::endian::native == std::endian::big);
}

// Dimensions of 1 are left out: (480, 640, 1) is an image too.
void read_shape(std::string_view text, const DepthRequest& request, NpyHeader& header) {
    const std::size_t end = text.find(')');
    const std::runtime_error error = request.error("must hold an array of two dimensions, height and width");
    if (text.empty() || text[0] != '(' || end == text.npos) throw error;
    std::string part;
    for (const char c : text.substr(1, end)) {
        if (c >= '0' && c <= '9') part += c;
        if (c != ',' && c != ')') continue;
        const std::optional<std::int64_t> length = parse_integer(part);
        if (length && *length != 1) header.shape.push_back(*length);
        part.clear();
    }
    if (header.shape.size() != 2) throw error;
}

NpyHeader read_header(std::string_view bytes, const DepthRequest& request) {
    constexpr std::size_t kVersionAt = 6, kLengthAt = 8;
    if (bytes.size() < 12) throw request.error("the NPY file is cut short");
    const std::size_t length_bytes = bytes[kVersionAt] == 1 ? 2 : 4;
    std::size_t length = 0;
    for (std::size_t i = length_bytes; i-- > 0;)
        length = length << 8 | static_cast<unsigned char>(bytes[kLengthAt + i]);
    NpyHeader header;
    header.data_begin = kLengthAt + length_bytes + length;
    if (header.data_begin > bytes.size()) throw request.error("the NPY file is cut short");
    const std::string_view text = bytes.substr(kLengthAt + length_bytes, length);
    read_type(value_of(text, "descr", request), request, header);
    header.columns_first = value_of(text, "fortran_order", request).starts_with("True");
    read_shape(value_of(text, "shape", request), request, header);
    for (const std::int64_t side : header.shape) {
        if (side < 1 || side > kMaxImageSide) {
            throw request.error("has a side of " + std::to_string(side) + " pixels; at most " +
                                std::to_string(kMaxImageSide) + " are read");
        }
    }
    return header;
}

template <typename Number>
float number_at(const std::array<char, 8>& bytes) {
    Number number{};
    std::memcpy(&number, bytes.data(), sizeof number);
    return static_cast<float>(number);
}

float value_at(const char* data, const NpyHeader& header) {
    std::array<char, 8> bytes{};
    for (std::size_t i = 0; i < header.bytes; ++i) bytes[i] = data[header.swap ? header.bytes - 1 - i : i];
    if (header.kind == 'f') return header.bytes == 4 ? number_at<float>(bytes) : number_at<double>(bytes);
    const bool is_signed = header.kind == 'i';
    if (header.bytes == 1) return number_at<std::uint8_t>(bytes);
    if (header.bytes == 2) return is_signed ? number_at<std::int16_t>(bytes) : number_at<std::uint16_t>(bytes);
    return is_signed ? number_at<std::int32_t>(bytes) : number_at<std::uint32_t>(bytes);
}

}  // namespace

NumberImage read_npy(const DepthRequest& request) {
    const NpyHeader header = read_header(read_file_start(request.path, kMaxHeaderBytes), request);
    const auto rows = static_cast<std::size_t>(header.shape[0]), columns = static_cast<std::size_t>(header.shape[1]);
    NumberImage image{static_cast<int>(columns), static_cast<int>(rows), header.kind == 'f', {}};
    request.check_size({image.width, image.height});
    if (!request.with_pixels) return image;
    const std::size_t data_bytes = rows * columns * header.bytes;
    const std::string bytes = read_whole_file(request.path, header.data_begin + data_bytes + kMaxHeaderBytes);
    if (bytes.size() < header.data_begin + data_bytes) throw request.error("the NPY file is cut short");
    image.values.resize(rows * columns);
    for (std::size_t i = 0; i < image.values.size(); ++i) {
        const std::size_t place = header.columns_first ? i % columns * rows + i / columns : i;
        image.values[i] = value_at(bytes.data() + header.data_begin + place * header.bytes, header);
    }
    return image;
}

}  // namespace nearpose::data_set
