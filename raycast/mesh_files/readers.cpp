#include "raycast/mesh_files/readers.hpp"

#include <fstream>
#include <stdexcept>

namespace nearpose {

std::string_view without_byte_order_mark(std::string_view text) {
    constexpr std::string_view kMark = "\xEF\xBB\xBF";
    return text.starts_with(kMark) ? text.substr(kMark.size()) : text;
}

bool is_padding(std::string_view bytes) {
    return bytes.find_first_not_of(std::string_view(" \t\r\n\0", 5)) == bytes.npos;
}

std::string read_regular_file(const std::filesystem::path& path, std::uint64_t max_bytes) {
    std::error_code error;
    const std::filesystem::file_status status = std::filesystem::status(path, error);
    if (!std::filesystem::exists(status)) throw std::runtime_error(path.string() + ": no such file");
    if (!std::filesystem::is_regular_file(status)) throw std::runtime_error(path.string() + ": not a regular file");
    const std::uintmax_t size = std::filesystem::file_size(path, error);
    if (error) throw std::runtime_error(path.string() + ": " + error.message());
    if (size > max_bytes) {
        throw std::runtime_error(path.string() + ": " + std::to_string(size) + " bytes are more than the limit of " +
                                 std::to_string(max_bytes));
    }
    std::string bytes(static_cast<std::size_t>(size), '\0');
    std::ifstream file(path, std::ios::binary);
    if (!file.read(bytes.data(), static_cast<std::streamsize>(size))) {
        throw std::runtime_error(path.string() + ": cannot be read");
    }
    return bytes;
}

}  // namespace nearpose
