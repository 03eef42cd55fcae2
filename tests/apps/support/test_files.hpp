// Small files for the tests of the formats.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace nearpose::data_set::testing_files {

// A new folder of the running test's own name, below the tests' temporary folder.
inline std::filesystem::path new_folder() {
    const testing::TestInfo* test = testing::UnitTest::GetInstance()->current_test_info();
    const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "nearpose_data_set" /
                                         (std::string(test->test_suite_name()) + "." + test->name());
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder);
    return folder;
}

inline std::filesystem::path write_text(const std::filesystem::path& path, std::string_view text) {
    std::filesystem::create_directories(path.parent_path());
    std::ofstream file(path, std::ios::binary);
    file.write(text.data(), static_cast<std::streamsize>(text.size()));
    file.close();
    if (!file) throw std::runtime_error("the test cannot write " + path.string());
    return path;
}

inline std::string read_text(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

// Names of the entries of a folder: shows that no temporary file is left.
inline std::size_t entries_of(const std::filesystem::path& folder) {
    return static_cast<std::size_t>(
        std::distance(std::filesystem::directory_iterator(folder), std::filesystem::directory_iterator()));
}

// Expects an exception whose text holds all of `parts` (the file, the cause).
inline void expect_error(const std::function<void()>& call, const std::vector<std::string>& parts) {
    try {
        call();
    } catch (const std::exception& error) {
        for (const std::string& part : parts)
            EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
        return;
    }
    ADD_FAILURE() << "no exception; expected one with: " << (parts.empty() ? "" : parts.back());
}

inline std::string big_endian(std::uint32_t value) {
    return {static_cast<char>(value >> 24), static_cast<char>(value >> 16), static_cast<char>(value >> 8),
            static_cast<char>(value)};
}

inline std::string png_chunk(const std::string& name, const std::string& data) {
    std::uint32_t crc = 0xffffffffU;
    for (const char c : name + data) {
        crc ^= static_cast<unsigned char>(c);
        for (int bit = 0; bit < 8; ++bit) crc = (crc & 1U) != 0 ? crc >> 1 ^ 0xedb88320U : crc >> 1;
    }
    return big_endian(static_cast<std::uint32_t>(data.size())) + name + data + big_endian(~crc);
}

// zlib data without compression: blocks of at most 65535 bytes.
inline std::string zlib_stored(const std::string& raw) {
    std::string text = {'\x78', '\x01'};
    for (std::size_t begin = 0; begin < raw.size(); begin += 65535) {
        const std::size_t length = std::min<std::size_t>(65535, raw.size() - begin);
        text += static_cast<char>(begin + length == raw.size() ? 1 : 0);
        for (const std::size_t value : {length, ~length}) {
            text += static_cast<char>(value);
            text += static_cast<char>(value >> 8);
        }
        text += raw.substr(begin, length);
    }
    std::uint32_t a = 1;
    std::uint32_t b = 0;
    for (const char c : raw) {
        a = (a + static_cast<unsigned char>(c)) % 65521;
        b = (b + a) % 65521;
    }
    return text + big_endian(b << 16 | a);
}

// A PNG of any kind in one IDAT chunk. `rows` are the bytes of the rows, each with its filter byte (0) first.
inline std::string png_bytes(std::uint32_t width, std::uint32_t height, int bit_depth, int color_type,
                             const std::string& rows) {
    const std::string header = big_endian(width) + big_endian(height) + static_cast<char>(bit_depth) +
                               static_cast<char>(color_type) + std::string(3, '\0');
    return "\x89PNG\r\n\x1a\n" + png_chunk("IHDR", header) + png_chunk("IDAT", zlib_stored(rows)) +
           png_chunk("IEND", "");
}

// A data set's scene with frames 0..2 of 4 x 3 pixels, counts = frame number + 1, no masks. Returns
// <folder>/test/000005.
std::filesystem::path write_small_scene(const std::filesystem::path& folder);

// Switches to a locale with a decimal comma for its life; ok() tells whether the machine has one.
class CommaLocale {
  public:
    CommaLocale();
    ~CommaLocale();
    CommaLocale(const CommaLocale&) = delete;
    CommaLocale& operator=(const CommaLocale&) = delete;
    bool ok() const { return ok_; }

  private:
    std::string before_;
    bool ok_ = false;
};

}  // namespace nearpose::data_set::testing_files
