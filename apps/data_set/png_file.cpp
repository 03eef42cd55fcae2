#include "apps/data_set/png_file.hpp"

#include <spng.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>

#include "apps/base/file_io.hpp"
#include "apps/base/number_text.hpp"

namespace nearpose::data_set {
namespace {

using Context = std::unique_ptr<spng_ctx, decltype(&spng_ctx_free)>;

std::runtime_error png_error(const std::filesystem::path& path, const std::string& problem) {
    return std::runtime_error(path.string() + ": " + problem);
}

void check(int code, const std::filesystem::path& path) {
    if (code == SPNG_OK) return;
    if (code == SPNG_IO_EOF) throw png_error(path, "the PNG is cut short");
    throw png_error(path, std::string("not a readable PNG: ") + spng_strerror(code));
}

std::string size_text(std::uint64_t width, std::uint64_t height) {
    return std::to_string(width) + " x " + std::to_string(height);
}

void check_cap(const std::filesystem::path& path, std::uint32_t width, std::uint32_t height) {
    if (width <= kMaxImageSide && height <= kMaxImageSide) return;
    throw png_error(path, "claims " + size_text(width, height) + " pixels; at most " + std::to_string(kMaxImageSide) +
                              " a side are read");
}

constexpr std::size_t kHeaderBytes = 24;  // signature, length and name of IHDR, width, height
constexpr std::size_t kWidthAt = 16, kHeightAt = 20;

constexpr std::string_view kSignature = "\x89PNG\r\n\x1a\n";
constexpr std::size_t kRosBytes = 12;  // a number for the format, and two floating point numbers

bool has_png_header(std::string_view bytes) {
    return bytes.size() >= kHeaderBytes && bytes.starts_with(kSignature);
}

// The first `count` bytes of the PNG, behind ROS's header where there is one, whose length goes to `skipped`. Numbers
// in that header are those by which floating point depth was made to counts of its inverse.
std::string png_start(const std::filesystem::path& path, std::size_t count, std::size_t& skipped) {
    std::string bytes = read_file_start(path, kRosBytes + count);
    const bool ros = !bytes.starts_with(kSignature) &&
                     std::string_view(bytes).substr(0, kRosBytes + kSignature.size()).ends_with(kSignature);
    skipped = ros && bytes.size() > kRosBytes ? kRosBytes : 0;
    if (skipped > 0 && bytes.find_first_not_of('\0', 4) < kRosBytes) {
        throw png_error(path,
                        "is a compressed ROS image of floating point depth, which holds inverse depth: export it "
                        "as counts of millimetres (16UC1), or as NPY");
    }
    return bytes.substr(skipped, count);
}

std::uint32_t big_endian_at(std::string_view bytes, std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
    return value;
}

// Room for the widest pixels (four channels of 16 bits) of an image that does not compress, and for other chunks.
std::uintmax_t max_png_bytes(std::string_view header) {
    constexpr std::uintmax_t kBytesPerPixel = 8, kOther = std::uintmax_t{16} << 20;
    return kBytesPerPixel * big_endian_at(header, kWidthAt) * big_endian_at(header, kHeightAt) + kOther;
}

// An opened PNG whose header has been checked; nothing of the image's size is allocated yet.
struct OpenPng {
    std::string bytes;
    Context context{nullptr, &spng_ctx_free};
    spng_ihdr header{};
};

OpenPng open_png(const std::filesystem::path& path, ImageSize expected) {
    OpenPng png;
    std::size_t skipped = 0;
    png.bytes = png_start(path, kHeaderBytes, skipped);
    if (!has_png_header(png.bytes) && png.bytes.size() == kHeaderBytes) throw png_error(path, "is not a PNG");
    // Where a file is shorter, the library says what is wrong.
    if (has_png_header(png.bytes)) {
        check_cap(path, big_endian_at(png.bytes, kWidthAt), big_endian_at(png.bytes, kHeightAt));
        png.bytes = read_whole_file(path, max_png_bytes(png.bytes)).substr(skipped);
    }
    png.context.reset(spng_ctx_new(0));
    if (!png.context) throw std::bad_alloc();
    check(spng_set_png_buffer(png.context.get(), png.bytes.data(), png.bytes.size()), path);
    // Colour profiles and texts of any size have no business in a depth image.
    check(spng_set_chunk_limits(png.context.get(), 1u << 20, 4u << 20), path);
    check(spng_get_ihdr(png.context.get(), &png.header), path);
    const std::uint32_t width = png.header.width;
    const std::uint32_t height = png.header.height;
    check_cap(path, width, height);
    const bool width_differs = expected.width > 0 && static_cast<int>(width) != expected.width;
    const bool height_differs = expected.height > 0 && static_cast<int>(height) != expected.height;
    if (width_differs || height_differs) {
        throw png_error(path, "has " + size_text(width, height) + " pixels, but " +
                                  size_text(expected.width, expected.height) + " are expected");
    }
    // Deflate packs at most 1032 bytes into one: a file too small for what it claims is cut or a trap.
    const std::uint64_t bits = std::uint64_t{width} * height * png.header.bit_depth;
    if (bits / 8 > std::uint64_t{1032} * png.bytes.size()) {
        throw png_error(path, "the PNG is cut short: " + std::to_string(png.bytes.size()) + " bytes cannot hold " +
                                  size_text(width, height) + " pixels");
    }
    return png;
}

void decode(OpenPng& png, void* pixels, std::size_t byte_count, int format, const std::filesystem::path& path) {
    // The library is content with a file that lacks its last bytes if all pixels are there; a copy that broke off is
    // not to be trusted.
    constexpr std::string_view kEnd("\0\0\0\0IEND\xae\x42\x60\x82", 12);
    if (png.bytes.rfind(kEnd) == png.bytes.npos) throw png_error(path, "the PNG is cut short");
    std::size_t needed = 0;
    check(spng_decoded_image_size(png.context.get(), format, &needed), path);
    if (needed != byte_count) throw png_error(path, "has pixels of an unexpected size");
    check(spng_decode_image(png.context.get(), pixels, byte_count, format, 0), path);
    // The pixels' own check sum stands at their end. What is odd about chunks behind them is of no concern.
    const int rest = spng_decode_chunks(png.context.get());
    if (rest == SPNG_ECHUNK_CRC || rest == SPNG_IO_EOF) check(rest, path);
}

// `path` is for messages.
std::string encode_png(const std::filesystem::path& path, ImageSize size, std::uint8_t bit_depth,
                       std::uint8_t color_type, const void* pixels, std::size_t byte_count) {
    if (size.width < 1 || size.height < 1 || size.width > kMaxImageSide || size.height > kMaxImageSide) {
        throw std::invalid_argument(path.string() + ": a picture of " + std::to_string(size.width) + " x " +
                                    std::to_string(size.height) + " pixels cannot be written");
    }
    const Context context(spng_ctx_new(SPNG_CTX_ENCODER), &spng_ctx_free);
    if (!context) throw std::bad_alloc();
    spng_ihdr header{};
    header.width = static_cast<std::uint32_t>(size.width);
    header.height = static_cast<std::uint32_t>(size.height);
    header.bit_depth = bit_depth;
    header.color_type = color_type;
    const auto require = [&](int code) {
        if (code != SPNG_OK) throw png_error(path, std::string("cannot be encoded: ") + spng_strerror(code));
    };
    require(spng_set_option(context.get(), SPNG_ENCODE_TO_BUFFER, 1));
    // A scene has thousands of images: level 3 takes a fifth of the default's time for a seventh more bytes.
    require(spng_set_option(context.get(), SPNG_IMG_COMPRESSION_LEVEL, 3));
    require(spng_set_ihdr(context.get(), &header));
    require(spng_encode_image(context.get(), pixels, byte_count, SPNG_FMT_PNG, SPNG_ENCODE_FINALIZE));
    std::size_t length = 0;
    int code = SPNG_OK;
    const std::unique_ptr<void, decltype(&std::free)> bytes(spng_get_png_buffer(context.get(), &length, &code),
                                                            &std::free);
    require(code);
    return {static_cast<const char*>(bytes.get()), length};
}

void write_png(const std::filesystem::path& path, ImageSize size, std::uint8_t bit_depth, std::uint8_t color_type,
               const void* pixels, std::size_t byte_count) {
    write_file_atomically(path, encode_png(path, size, bit_depth, color_type, pixels, byte_count));
}

void check_scale(double depth_scale_mm) {
    if (!(depth_scale_mm > 0.0) || !std::isfinite(depth_scale_mm)) {
        throw std::invalid_argument("depth scale is " + format_number(depth_scale_mm) +
                                    " mm per count, but must be positive and finite");
    }
}

std::size_t pixel_count(int width, int height) {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
}

}  // namespace

ImageSize read_png_size(const std::filesystem::path& path) {
    // The header alone, by hand: a scene asks this of all its images before it starts.
    std::size_t skipped = 0;
    const std::string bytes = png_start(path, kHeaderBytes, skipped);
    if (!has_png_header(bytes)) throw png_error(path, "is not a PNG");
    const std::uint32_t width = big_endian_at(bytes, kWidthAt);
    const std::uint32_t height = big_endian_at(bytes, kHeightAt);
    check_cap(path, width, height);
    return {static_cast<int>(width), static_cast<int>(height)};
}

CountImage read_count_png(const std::filesystem::path& path, int expected_width, int expected_height) {
    OpenPng png = open_png(path, {expected_width, expected_height});
    if (png.header.bit_depth != 16) {
        throw png_error(path,
                        "has " + std::to_string(png.header.bit_depth) +
                            " bits a channel, but depth needs 16-bit grey. An 8-bit depth image is a coloured "
                            "picture and its depth is lost: export with rs-convert -r (raw), never with -p (PNG)");
    }
    if (png.header.color_type != SPNG_COLOR_TYPE_GRAYSCALE) {
        throw png_error(path, "is a colour picture, but depth needs 16-bit grey");
    }
    CountImage image{static_cast<int>(png.header.width), static_cast<int>(png.header.height), {}};
    image.counts.resize(pixel_count(image.width, image.height));
    decode(png, image.counts.data(), image.counts.size() * sizeof(std::uint16_t), SPNG_FMT_PNG, path);
    return image;
}

void write_count_png(const std::filesystem::path& path, const CountImage& image) {
    if (image.counts.size() != pixel_count(image.width, image.height)) {
        throw std::invalid_argument(path.string() + ": the counts do not fill the image");
    }
    write_png(path, {image.width, image.height}, 16, SPNG_COLOR_TYPE_GRAYSCALE, image.counts.data(),
              image.counts.size() * sizeof(std::uint16_t));
}

DepthImage depth_from_counts(const CountImage& image, double depth_scale_mm) {
    check_scale(depth_scale_mm);
    DepthImage depth{image.width, image.height, std::vector<float>(image.counts.size())};
    std::transform(image.counts.begin(), image.counts.end(), depth.depth_m.begin(),
                   [&](std::uint16_t count) { return static_cast<float>(count * depth_scale_mm * 1e-3); });
    return depth;
}

CountImage counts_from_depth(const DepthImage& image, double depth_scale_mm) {
    check_scale(depth_scale_mm);
    CountImage counts{image.width, image.height, std::vector<std::uint16_t>(image.depth_m.size())};
    for (std::size_t i = 0; i < image.depth_m.size(); ++i) {
        const double depth_m = image.depth_m[i];
        if (!(depth_m > 0.0)) continue;  // NaN too
        const double count = std::round(depth_m * 1e3 / depth_scale_mm);
        if (count > 65535.0 || count < 1.0) {
            throw std::invalid_argument("a depth of " + format_number(depth_m) + " m does not fit 16 bits at " +
                                        format_number(depth_scale_mm) + " mm per count");
        }
        counts.counts[i] = static_cast<std::uint16_t>(count);
    }
    return counts;
}

DepthImage read_depth_png(const std::filesystem::path& path, double depth_scale_mm, int expected_width,
                          int expected_height) {
    return depth_from_counts(read_count_png(path, expected_width, expected_height), depth_scale_mm);
}

void write_depth_png(const std::filesystem::path& path, const DepthImage& image, double depth_scale_mm) {
    write_count_png(path, counts_from_depth(image, depth_scale_mm));
}

Mask read_mask_png(const std::filesystem::path& path, int expected_width, int expected_height) {
    OpenPng png = open_png(path, {expected_width, expected_height});
    Mask mask{static_cast<int>(png.header.width), static_cast<int>(png.header.height), {}};
    mask.value.resize(pixel_count(mask.width, mask.height));
    const bool grey = png.header.color_type == SPNG_COLOR_TYPE_GRAYSCALE;
    if (grey && png.header.bit_depth <= 8) {
        decode(png, mask.value.data(), mask.value.size(), SPNG_FMT_G8, path);
        return mask;
    }
    constexpr std::size_t kChannels = 4;  // RGBA holds whatever else there is; 16 bits, so that a 1 of 65535 stays a 1
    std::vector<std::uint16_t> colours(mask.value.size() * kChannels);
    decode(png, colours.data(), colours.size() * sizeof(std::uint16_t), SPNG_FMT_RGBA16, path);
    std::size_t transparent = 0;
    for (std::size_t i = 0; i < mask.value.size(); ++i) transparent += colours[i * kChannels + 3] == 0 ? 1 : 0;
    const bool alpha_is_mask = transparent > 0 && transparent < mask.value.size();
    for (std::size_t i = 0; i < mask.value.size(); ++i) {
        const std::uint16_t* colour = &colours[i * kChannels];
        const int shown = alpha_is_mask ? colour[3] : colour[0] | colour[1] | colour[2];
        mask.value[i] = shown != 0 ? 255 : 0;
    }
    return mask;
}

void write_mask_png(const std::filesystem::path& path, const Mask& mask) {
    if (mask.value.size() != pixel_count(mask.width, mask.height)) {
        throw std::invalid_argument(path.string() + ": the mask's values do not fill the image");
    }
    std::vector<std::uint8_t> grey(mask.value.size());
    std::transform(mask.value.begin(), mask.value.end(), grey.begin(),
                   [](std::uint8_t value) { return static_cast<std::uint8_t>(value != 0 ? 255 : 0); });
    write_png(path, {mask.width, mask.height}, 8, SPNG_COLOR_TYPE_GRAYSCALE, grey.data(), grey.size());
}

std::string grey_png_bytes(int width, int height, std::span<const std::uint8_t> grey) {
    if (width < 0 || height < 0 || grey.size() != pixel_count(width, height)) {
        throw std::invalid_argument("the grey values do not fill the picture");
    }
    return encode_png("picture", {width, height}, 8, SPNG_COLOR_TYPE_GRAYSCALE, grey.data(), grey.size());
}

void write_rgb_png(const std::filesystem::path& path, int width, int height, std::span<const std::uint8_t> rgb) {
    if (width < 0 || height < 0 || rgb.size() != 3 * pixel_count(width, height)) {
        throw std::invalid_argument(path.string() + ": the colours do not fill the picture");
    }
    write_png(path, {width, height}, 8, SPNG_COLOR_TYPE_TRUECOLOR, rgb.data(), rgb.size());
}

}  // namespace nearpose::data_set
