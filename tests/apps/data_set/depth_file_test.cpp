#include "apps/data_set/depth_file.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "tests/apps/support/test_files.hpp"

namespace nearpose::data_set {
namespace {

namespace fs = std::filesystem;
using namespace testing_files;

template <typename Number>
std::string bytes_of(const std::vector<Number>& numbers, bool swap = false) {
    std::string bytes;
    for (const Number number : numbers) {
        std::string one(sizeof number, '\0');
        std::memcpy(one.data(), &number, sizeof number);
        if (swap) std::reverse(one.begin(), one.end());
        bytes += one;
    }
    return bytes;
}

std::string npy(const std::string& type, const std::string& shape, const std::string& data,
                const std::string& order = "False") {
    std::string header = "{'descr': '" + type + "', 'fortran_order': " + order + ", 'shape': " + shape + ", }";
    header.resize((header.size() + 10 + 64) / 64 * 64 - 10, ' ');
    return std::string("\x93NUMPY\x01\0", 8) + bytes_of<std::uint16_t>({static_cast<std::uint16_t>(header.size())}) +
           header + data;
}

// One strip, little endian. `format`: 1 whole without a sign, 3 floating point.
std::string tiff(std::uint32_t width, std::uint32_t height, std::uint16_t bits, std::uint16_t format,
                 const std::string& data, std::uint16_t samples = 1) {
    struct Tag {
        std::uint16_t tag, type;
        std::uint32_t value;
    };
    const std::uint32_t bytes = static_cast<std::uint32_t>(data.size());
    const std::vector<Tag> tags = {{256, 4, width}, {257, 4, height}, {258, 3, bits},    {259, 3, 1},
                                   {262, 3, 1},     {273, 4, 8},      {277, 3, samples}, {278, 4, height},
                                   {279, 4, bytes}, {339, 3, format}};
    std::string file = std::string("II*\0", 4) + bytes_of<std::uint32_t>({8 + bytes}) + data +
                       bytes_of<std::uint16_t>({static_cast<std::uint16_t>(tags.size())});
    for (const Tag& tag : tags) {
        file += bytes_of<std::uint16_t>({tag.tag, tag.type}) + bytes_of<std::uint32_t>({1, tag.value});
    }
    return file + std::string(4, '\0');
}

// Uncompressed rows of 32-bit floating point numbers in one channel, or the same in several.
std::string exr(int width, int height, const std::vector<std::string>& channels, const std::vector<float>& values) {
    const auto attribute = [](const std::string& name, const std::string& type, const std::string& value) {
        return name + '\0' + type + '\0' + bytes_of<std::int32_t>({static_cast<std::int32_t>(value.size())}) + value;
    };
    std::string list;
    for (const std::string& name : channels) list += name + '\0' + bytes_of<std::int32_t>({2, 0, 1, 1});
    const std::string window = bytes_of<std::int32_t>({0, 0, width - 1, height - 1});
    std::string file = "\x76\x2f\x31\x01" + bytes_of<std::int32_t>({2}) + attribute("channels", "chlist", list + '\0') +
                       attribute("compression", "compression", std::string(1, '\0')) +
                       attribute("dataWindow", "box2i", window) + attribute("displayWindow", "box2i", window) +
                       attribute("lineOrder", "lineOrder", std::string(1, '\0')) +
                       attribute("pixelAspectRatio", "float", bytes_of<float>({1.0F})) +
                       attribute("screenWindowCenter", "v2f", bytes_of<float>({0.0F, 0.0F})) +
                       attribute("screenWindowWidth", "float", bytes_of<float>({1.0F})) + '\0';
    const std::size_t row_bytes = static_cast<std::size_t>(width) * 4 * channels.size();
    const std::size_t begin = file.size() + 8 * static_cast<std::size_t>(height);
    for (std::size_t row = 0; row < static_cast<std::size_t>(height); ++row) {
        file += bytes_of<std::uint64_t>({begin + row * (row_bytes + 8)});
    }
    const auto side = static_cast<std::ptrdiff_t>(width);
    for (int row = 0; row < height; ++row) {
        file += bytes_of<std::int32_t>({row, static_cast<std::int32_t>(row_bytes)});
        for (std::size_t i = 0; i < channels.size(); ++i) {
            file += bytes_of(std::vector<float>(values.begin() + row * side, values.begin() + (row + 1) * side));
        }
    }
    return file;
}

const std::vector<float> kMetres = {0.5F, 0.25F, 0.0F, 1.0F, std::numeric_limits<float>::infinity(), -1.0F};
const std::vector<std::uint16_t> kCounts = {500, 250, 0, 1000, 65535, 7};
const std::vector<float> kOfMetres = {0.5F, 0.25F, 0.0F, 1.0F, 0.0F, 0.0F};  // what is read
const std::vector<float> kOfCounts = {0.5F, 0.25F, 0.0F, 1.0F, 65.535F, 0.007F};

class DepthFile : public testing::Test {
  protected:
    const fs::path file_ = new_folder() / "depth";

    // False, and nothing, where the build lacks the format's library.
    bool readable(const std::string& bytes) {
        write_text(file_, bytes);
        try {
            return read_depth_size(file_) == ImageSize{3, 2};
        } catch (const std::runtime_error& error) {
            if (std::string(error.what()).find("built without") == std::string::npos) throw;
            return false;
        }
    }
    void expect_depth(const std::string& bytes, std::optional<double> scale_mm, const std::vector<float>& depth_m) {
        ASSERT_TRUE(readable(bytes));
        EXPECT_EQ(read_depth_file(file_, scale_mm, {3, 2}).depth_m, depth_m);
    }
    void expect_refused(const std::string& bytes, const std::vector<std::string>& parts) {
        write_text(file_, bytes);
        expect_error([&] { read_depth_file(file_, 1.0, {3, 2}); }, parts);
    }
};

TEST_F(DepthFile, IsReadByItsFirstBytesWhateverItsName) {
    write_count_png(file_, {3, 2, kCounts});
    EXPECT_EQ(read_depth_size(file_), (ImageSize{3, 2}));
    EXPECT_EQ(read_depth_file(file_, std::nullopt, {3, 2}).depth_m, kOfCounts);
    expect_refused("", {"depth", "PNG"});
    expect_refused("a text of some length that is no image", {"depth", "is not a PNG"});
}

TEST_F(DepthFile, OfNumpyHoldsCountsOrMetres) {
    expect_depth(npy("<u2", "(2, 3)", bytes_of(kCounts)), std::nullopt, kOfCounts);
    expect_depth(npy(">u2", "(2, 3, 1)", bytes_of(kCounts, true)), 1.0, kOfCounts);
    expect_depth(npy("<i4", "(1, 2, 3)", bytes_of<std::int32_t>({500, 250, 0, 1000, -5, 70000})), 1.0,
                 {0.5F, 0.25F, 0.0F, 1.0F, 0.0F, 70.0F});
    expect_depth(npy("<f4", "(2, 3)", bytes_of(kMetres)), std::nullopt, kOfMetres);
    expect_depth(npy("<f8", "(2, 3)", bytes_of<double>({500, 250, 0, 1000, NAN, -1})), 1.0, kOfMetres);
    // By columns.
    expect_depth(npy("<u2", "(2, 3)", bytes_of<std::uint16_t>({500, 1000, 250, 65535, 0, 7}), "True"), 1.0, kOfCounts);
}

TEST_F(DepthFile, OfNumpyIsRefusedWhereItIsNoImage) {
    const std::string good = npy("<u2", "(2, 3)", bytes_of(kCounts));
    expect_refused(good.substr(0, good.size() - 1), {"depth", "cut short"});
    expect_refused(good.substr(0, 40), {"depth", "cut short"});
    expect_refused(npy("<u2", "(3, 2)", bytes_of(kCounts)), {"2 x 3", "3 x 2"});
    expect_refused(npy("<u2", "(6,)", bytes_of(kCounts)), {"two dimensions"});
    expect_refused(npy("<u2", "(2, 99999)", ""), {"99999"});
    expect_refused(npy("<c8", "(2, 3)", ""), {"<c8", "uint16"});
    expect_refused(npy("|O", "(2, 3)", ""), {"|O", "uint16"});
}

TEST_F(DepthFile, OfTiffHoldsCountsOrMetres) {
    if (!readable(tiff(3, 2, 16, 1, bytes_of(kCounts)))) GTEST_SKIP() << "built without libtiff";
    expect_depth(tiff(3, 2, 16, 1, bytes_of(kCounts)), 1.0, kOfCounts);
    expect_depth(tiff(3, 2, 32, 3, bytes_of(kMetres)), std::nullopt, kOfMetres);
    expect_depth(tiff(3, 2, 32, 3, bytes_of(kMetres)), 1000.0, kOfMetres);
    expect_refused(tiff(2, 3, 16, 1, bytes_of(kCounts)), {"2 x 3", "3 x 2"});
    expect_refused(tiff(3, 2, 8, 1, std::string(6, '\1')), {"8 bits", "16-bit counts"});
    expect_refused(tiff(60000, 60000, 16, 1, ""), {"60000 x 60000"});
    expect_refused(tiff(3, 2, 16, 1, bytes_of(kCounts)).substr(0, 30), {"depth", "TIFF"});
}

TEST_F(DepthFile, OfExrIsTheChannelZ) {
    if (!readable(exr(3, 2, {"Z"}, kMetres))) GTEST_SKIP() << "built without OpenEXR";
    expect_depth(exr(3, 2, {"Z"}, kMetres), std::nullopt, kOfMetres);
    expect_depth(exr(3, 2, {"V"}, kMetres), std::nullopt, kOfMetres);
    expect_depth(exr(3, 2, {"A", "Z"}, kMetres), 1000.0, kOfMetres);
    expect_refused(exr(3, 2, {"B", "G", "R"}, kMetres), {"B, G, R", "channel Z"});
    expect_refused(exr(2, 3, {"Z"}, kMetres), {"2 x 3", "3 x 2"});
    const std::string good = exr(3, 2, {"Z"}, kMetres);
    expect_refused(good.substr(0, good.size() - 20), {"depth", "EXR"});
    expect_refused(good.substr(0, 60), {"depth", "EXR"});
}

// Whatever a byte is changed to, or where the file ends: an image of the size that is asked for, or an error.
TEST_F(DepthFile, ThatIsDamagedNeverCrashes) {
    for (const std::string& good : {npy("<u2", "(2, 3)", bytes_of(kCounts)), npy("<f4", "(2, 3)", bytes_of(kMetres)),
                                    tiff(3, 2, 16, 1, bytes_of(kCounts)), exr(3, 2, {"Z"}, kMetres)}) {
        const auto read = [&](const std::string& bytes) {
            write_text(file_, bytes);
            try {
                EXPECT_EQ(read_depth_file(file_, 1.0, {3, 2}).depth_m.size(), 6U);
            } catch (const std::runtime_error&) {
            }
        };
        for (std::size_t at = 0; at < good.size(); ++at) {
            std::string damaged = good;
            damaged[at] = static_cast<char>(damaged[at] ^ (at % 2 == 0 ? 0x01 : 0xff));
            read(damaged);
            if (at % 8 == 0) read(good.substr(0, at));
        }
    }
}

}  // namespace
}  // namespace nearpose::data_set
