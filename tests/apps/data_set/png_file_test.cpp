#include "apps/data_set/png_file.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cmath>
#include <limits>

#include "tests/apps/support/test_files.hpp"

namespace nearpose::data_set {
namespace {

namespace fs = std::filesystem;
using namespace testing_files;

CountImage ramp(int width, int height) {
    CountImage image{width, height, {}};
    for (int i = 0; i < width * height; ++i) image.counts.push_back(static_cast<std::uint16_t>(i * 977));
    return image;
}

TEST(PngFile, CountsComeBack) {
    const fs::path file = new_folder() / "a.png";
    const CountImage image = ramp(67, 31);
    write_count_png(file, image);
    const CountImage back = read_count_png(file, 67, 31);
    EXPECT_EQ(back.counts, image.counts);
    EXPECT_EQ(read_png_size(file), (ImageSize{67, 31}));
}

TEST(PngFile, CountsAreBigEndianInTheFile) {
    // By another writer: row 0 is 258, 1.
    const fs::path file = write_text(new_folder() / "a.png", png_bytes(2, 1, 16, 0, std::string("\0\1\2\0\1", 5)));
    EXPECT_EQ(read_count_png(file).counts, (std::vector<std::uint16_t>{258, 1}));
}

TEST(PngFile, DepthScaleIsMillimetresPerCount) {
    const fs::path file = new_folder() / "a.png";
    write_count_png(file, {2, 1, {0, 2000}});
    const DepthImage depth = read_depth_png(file, 0.125);
    EXPECT_EQ(depth.depth_m[0], 0.0F);
    EXPECT_FLOAT_EQ(depth.depth_m[1], 0.25F);
    write_depth_png(file, depth, 0.125);
    EXPECT_EQ(read_count_png(file).counts[1], 2000);
    EXPECT_THROW(read_depth_png(file, 0.0), std::invalid_argument);
    EXPECT_THROW(read_depth_png(file, std::nan("")), std::invalid_argument);
}

TEST(PngFile, DepthIsRoundedAndWhatDoesNotFitIsRefused) {
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
    const CountImage counts = counts_from_depth({5, 1, {0.0F, kNan, -1.0F, 0.0014F, 0.0016F}}, 1.0);
    EXPECT_EQ(counts.counts, (std::vector<std::uint16_t>{0, 0, 0, 1, 2}));
    expect_error([] { counts_from_depth({1, 1, {70.0F}}, 1.0); }, {"70", "16 bits"});
    expect_error([] { counts_from_depth({1, 1, {0.0001F}}, 1.0); }, {"16 bits"});
    expect_error([] { counts_from_depth({1, 1, {std::numeric_limits<float>::infinity()}}, 1.0); }, {"16 bits"});
}

TEST(PngFile, MissingAndCutFilesAreRefused) {
    const fs::path folder = new_folder();
    expect_error([&] { read_count_png(folder / "none.png"); }, {"none.png", "No such file"});
    expect_error([&] { read_png_size(folder / "none.png"); }, {"none.png"});
    write_count_png(folder / "whole.png", ramp(24, 16));
    const std::string whole = read_text(folder / "whole.png");
    for (std::size_t length = 0; length < whole.size(); length += 5) {
        write_text(folder / "cut.png", whole.substr(0, length));
        expect_error([&] { read_count_png(folder / "cut.png"); }, {"cut.png", "PNG"});
    }
}

TEST(PngFile, DamageIsNoticed) {
    const fs::path folder = new_folder();
    write_count_png(folder / "whole.png", ramp(7, 5));
    const std::string whole = read_text(folder / "whole.png");
    for (std::size_t at = 0; at < whole.size(); ++at) {
        std::string damaged = whole;
        damaged[at] = static_cast<char>(damaged[at] ^ 0x55);
        write_text(folder / "damaged.png", damaged);
        expect_error([&] { read_count_png(folder / "damaged.png"); }, {"damaged.png"});
    }
}

TEST(PngFile, EightBitDepthIsExplained) {
    const fs::path folder = new_folder();
    const fs::path grey = write_text(folder / "grey.png", png_bytes(2, 1, 8, 0, std::string("\0\1\2", 3)));
    expect_error([&] { read_depth_png(grey, 1.0); }, {"grey.png", "8 bits", "rs-convert -r", "-p"});
    write_rgb_png(folder / "rgb.png", 1, 1, std::vector<std::uint8_t>{1, 2, 3});
    expect_error([&] { read_depth_png(folder / "rgb.png", 1.0); }, {"rgb.png", "8 bits", "never with -p"});
    const fs::path rgb16 = write_text(folder / "rgb16.png", png_bytes(1, 1, 16, 2, std::string(7, '\0')));
    expect_error([&] { read_depth_png(rgb16, 1.0); }, {"rgb16.png", "16-bit grey"});
}

TEST(PngFile, AnotherSizeIsRefused) {
    const fs::path file = new_folder() / "a.png";
    write_count_png(file, ramp(4, 3));
    expect_error([&] { read_depth_png(file, 1.0, 3, 4); }, {"a.png", "4 x 3", "3 x 4"});
    expect_error([&] { read_mask_png(file, 4, 4); }, {"a.png", "4 x 3", "4 x 4"});
}

TEST(PngFile, AFalseSizeCostsNoMemory) {
    const fs::path folder = new_folder();
    const fs::path huge = write_text(folder / "huge.png", png_bytes(65535, 65535, 16, 0, std::string(1200, '\0')));
    const fs::path large = write_text(folder / "large.png", png_bytes(16384, 16384, 16, 0, std::string(1200, '\0')));
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    const long before_kib = usage.ru_maxrss;
    expect_error([&] { read_count_png(huge); }, {"huge.png", "65535 x 65535", "16384"});
    expect_error([&] { read_png_size(huge); }, {"huge.png", "65535 x 65535"});
    expect_error([&] { read_count_png(huge, 640, 480); }, {"huge.png"});
    expect_error([&] { read_mask_png(huge); }, {"huge.png"});
    expect_error([&] { read_count_png(large); }, {"large.png", "cut short"});  // 512 MB if it were believed
    getrusage(RUSAGE_SELF, &usage);
    EXPECT_LT(usage.ru_maxrss - before_kib, 100'000);
}

TEST(PngFile, OneLargeChunkIsFine) {
    // Some writers put the whole image in one IDAT; the limit on chunks is for others.
    std::string rows;
    for (int v = 0; v < 1000; ++v) rows.append(1, '\0').append(2400, static_cast<char>(v));
    const fs::path file = write_text(new_folder() / "a.png", png_bytes(1200, 1000, 16, 0, rows));
    const CountImage image = read_count_png(file);
    EXPECT_EQ(image.counts[5 * 1200], 5 * 256 + 5);
}

TEST(PngFile, MasksOfManyKinds) {
    const fs::path folder = new_folder();
    const Mask mask{3, 2, {0, 1, 0, 255, 0, 7}};
    write_mask_png(folder / "mask.png", mask);
    EXPECT_EQ(read_mask_png(folder / "mask.png", 3, 2).value, (std::vector<std::uint8_t>{0, 255, 0, 255, 0, 255}));
    const fs::path one_bit = write_text(folder / "one.png", png_bytes(3, 1, 1, 0, std::string("\0\x40", 2)));
    EXPECT_EQ(read_mask_png(one_bit).value, (std::vector<std::uint8_t>{0, 255, 0}));
    const fs::path deep = write_text(folder / "deep.png", png_bytes(2, 1, 16, 0, std::string("\0\0\0\0\1", 5)));
    EXPECT_EQ(read_mask_png(deep).value, (std::vector<std::uint8_t>{0, 255}));
    write_rgb_png(folder / "rgb.png", 2, 1, std::vector<std::uint8_t>{0, 0, 0, 0, 0, 9});
    EXPECT_EQ(read_mask_png(folder / "rgb.png").value, (std::vector<std::uint8_t>{0, 255}));
}

TEST(PngFile, AMaskMayStandInTheAlphaChannel) {
    const fs::path folder = new_folder();
    const auto rgba = [&](const std::string& row) {
        return read_mask_png(write_text(folder / "a.png", png_bytes(3, 1, 8, 6, '\0' + row))).value;
    };
    const std::vector<std::uint8_t> middle = {0, 255, 0};
    const std::string none(4, '\0'), full(4, '\xff');
    EXPECT_EQ(rgba(none + full + none), middle);
    EXPECT_EQ(rgba(std::string("\xff\xff\xff\0", 4) + full + std::string("\xff\xff\xff\0", 4)), middle);  // white
    EXPECT_EQ(rgba(none + std::string("\0\0\0\x80", 4) + none), middle);  // black, half transparent
    // Where alpha tells nothing the colour does.
    EXPECT_EQ(rgba(std::string("\0\0\0\xff", 4) + full + std::string("\0\0\0\xff", 4)), middle);
    EXPECT_EQ(rgba(none + std::string("\xff\0\0\0", 4) + none), middle);
    EXPECT_EQ(rgba(std::string("\0\0\0\x80", 4) + full + std::string("\0\0\0\x80", 4)), middle);
}

TEST(PngFile, BrokenChunksBesideThePixelsArePassedOver) {
    const fs::path folder = new_folder();
    write_count_png(folder / "whole.png", ramp(7, 5));
    const std::string whole = read_text(folder / "whole.png");
    const std::size_t data_begin = 33, end_begin = whole.size() - 12;  // behind the header, before IEND
    std::string bad_sum = png_chunk("gAMA", std::string("\0\0\1\0", 4));
    bad_sum.back() = static_cast<char>(bad_sum.back() ^ 1);
    for (const std::string& chunk :
         {bad_sum, png_chunk("gAMA", "x"), png_chunk("tEXt", "no end of the name"), png_chunk("tIME", "abcdefg"),
          png_chunk("zTXt", std::string("a\0\0rubbish", 10)), png_chunk("iCCP", std::string("a\0\0rubbish", 10)),
          png_chunk("pHYs", ""), png_chunk("eXIf", "rubbish"), png_chunk("sBIT", "\x63"),
          png_chunk("abCd", "private")}) {
        for (const std::size_t place : {data_begin, end_begin}) {
            write_text(folder / "odd.png", whole.substr(0, place) + chunk + whole.substr(place));
            EXPECT_EQ(read_count_png(folder / "odd.png").counts, ramp(7, 5).counts) << chunk.substr(4, 4) << place;
        }
    }
}

TEST(PngFile, TheHeaderOfACompressedRosImageIsPassedOver) {
    const fs::path folder = new_folder();
    write_count_png(folder / "whole.png", ramp(7, 5));
    const std::string whole = read_text(folder / "whole.png");
    const fs::path file = write_text(folder / "ros.png", std::string(12, '\0') + whole);
    EXPECT_EQ(read_count_png(file).counts, ramp(7, 5).counts);
    EXPECT_EQ(read_png_size(file), (ImageSize{7, 5}));
    // Parameters of its inverse depth.
    write_text(file, std::string(4, '\0') + "\1\2\3\4\1\2\3\4" + whole);
    expect_error([&] { read_count_png(file); }, {"ros.png", "floating point depth"});
    write_text(file, std::string(11, '\0') + whole);
    expect_error([&] { read_count_png(file); }, {"ros.png", "not a PNG"});
}

TEST(PngFile, AFullDiskAndWrongArgumentsAreReported) {
    expect_error([] { write_count_png("/dev/full", ramp(4, 4)); }, {"/dev/full", "No space left"});
    expect_error([] { write_rgb_png("x.png", 2, 2, std::vector<std::uint8_t>(5)); }, {"x.png"});
    expect_error([] { write_count_png("x.png", {2, 2, {1}}); }, {"x.png"});
    expect_error([] { write_mask_png("x.png", {0, 0, {}}); }, {"x.png", "0 x 0"});
}

}  // namespace
}  // namespace nearpose::data_set
