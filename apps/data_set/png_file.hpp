// PNG files: depth (16-bit grey), masks (grey), pictures (RGB).
//
// Sizes are compared with what is expected, with a cap, and with what a file of that many bytes can hold at all, before
// anything is allocated. Broken chunks beside the pixels are passed over, as is the header of 12 bytes that ROS puts
// before a PNG of counts (compressedDepth). All functions throw std::runtime_error naming the file and the cause.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/base/depth_image.hpp"

namespace nearpose::data_set {

inline constexpr int kMaxImageSide = 16384;  // [pixels]

struct ImageSize {
    int width = 0;   // [pixels]
    int height = 0;  // [pixels]
    bool operator==(const ImageSize&) const = default;
};

// Row-major 16-bit counts as they stand in the file.
struct CountImage {
    int width = 0;   // [pixels]
    int height = 0;  // [pixels]
    std::vector<std::uint16_t> counts;
};

// From the header alone; also checks the cap on the sides.
ImageSize read_png_size(const std::filesystem::path& path);

// Only 16-bit grey is accepted. A width or height of 0 expects any.
CountImage read_count_png(const std::filesystem::path& path, int expected_width = 0, int expected_height = 0);
void write_count_png(const std::filesystem::path& path, const CountImage& image);

// Depth in metres: count * depth_scale_mm / 1000; 0 stays 0 (no measurement).
DepthImage depth_from_counts(const CountImage& image, double depth_scale_mm);
// Counts rounded to nearest. 0, NaN and negative depths give 0; a depth beyond 65535 counts throws
// std::invalid_argument: it would come back as another depth. So does a depth that rounds to 0 counts.
CountImage counts_from_depth(const DepthImage& image, double depth_scale_mm);

DepthImage read_depth_png(const std::filesystem::path& path, double depth_scale_mm, int expected_width = 0,
                          int expected_height = 0);
void write_depth_png(const std::filesystem::path& path, const DepthImage& image, double depth_scale_mm);

// Grey of 1, 2, 4, 8 or 16 bits, palette or RGB(A): any colour but black is the object. Where an alpha channel makes
// some pixels fully transparent and others not, it is the mask, and the colours are ignored.
Mask read_mask_png(const std::filesystem::path& path, int expected_width = 0, int expected_height = 0);
void write_mask_png(const std::filesystem::path& path, const Mask& mask);  // 8-bit grey, 0 and 255

// The bytes of an 8-bit grey PNG, for what is embedded elsewhere. `grey` is row-major.
std::string grey_png_bytes(int width, int height, std::span<const std::uint8_t> grey);
// `rgb` holds 3 bytes a pixel, row-major.
void write_rgb_png(const std::filesystem::path& path, int width, int height, std::span<const std::uint8_t> rgb);

}  // namespace nearpose::data_set
