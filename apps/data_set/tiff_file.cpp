#include "apps/data_set/depth_readers.hpp"

#ifdef NEARPOSE_TIFF
#include <tiffio.h>

#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <memory>

#include "apps/base/file_io.hpp"
#endif

namespace nearpose::data_set {

#ifdef NEARPOSE_TIFF
namespace {

using File = std::unique_ptr<TIFF, decltype(&TIFFClose)>;
using OpenOptions = std::unique_ptr<TIFFOpenOptions, decltype(&TIFFOpenOptionsFree)>;

// The library's last message goes to the std::string behind `user`; it must not print.
int keep_message(TIFF*, void* user, const char*, const char* format, va_list arguments) {
    std::array<char, 256> text{};
    std::vsnprintf(text.data(), text.size(), format, arguments);
    *static_cast<std::string*>(user) = text.data();
    return 1;
}

int drop_message(TIFF*, void*, const char*, const char*, va_list) {
    return 1;
}

File open(const DepthRequest& request, std::string& message) {
    read_file_start(request.path, 1);  // refuses pipes and folders
    const OpenOptions options(TIFFOpenOptionsAlloc(), &TIFFOpenOptionsFree);
    TIFFOpenOptionsSetErrorHandlerExtR(options.get(), keep_message, &message);
    TIFFOpenOptionsSetWarningHandlerExtR(options.get(), drop_message, nullptr);
    TIFFOpenOptionsSetMaxSingleMemAlloc(options.get(), tmsize_t{1} << 30);
    File file(TIFFOpenExt(request.path.c_str(), "rm", options.get()), &TIFFClose);
    if (!file) throw request.error("not a readable TIFF: " + message);
    return file;
}

std::uint32_t field(TIFF* file, std::uint32_t tag) {
    std::uint32_t value = 0;
    TIFFGetField(file, tag, &value);
    return value;
}

std::uint16_t small_field(TIFF* file, std::uint32_t tag) {
    std::uint16_t value = 0;
    TIFFGetFieldDefaulted(file, tag, &value);
    return value;
}

void read_rows(TIFF* file, const DepthRequest& request, const std::string& message, NumberImage& image) {
    const auto width = static_cast<std::size_t>(image.width), height = static_cast<std::size_t>(image.height);
    const std::size_t row_bytes = width * (image.real ? sizeof(float) : sizeof(std::uint16_t));
    if (static_cast<std::size_t>(TIFFScanlineSize(file)) != row_bytes) throw request.error("has rows of an odd size");
    image.values.resize(width * height);
    std::vector<std::uint16_t> counts(image.real ? 0 : width);
    for (std::size_t row = 0; row < height; ++row) {
        float* values = image.values.data() + row * width;
        void* target = image.real ? static_cast<void*>(values) : counts.data();
        if (TIFFReadScanline(file, target, static_cast<std::uint32_t>(row), 0) != 1) {
            throw request.error("not a readable TIFF: " + message);
        }
        if (!image.real) std::copy(counts.begin(), counts.end(), values);
    }
}

}  // namespace

NumberImage read_tiff(const DepthRequest& request) {
    std::string message;
    const File file = open(request, message);
    const std::uint32_t width = field(file.get(), TIFFTAG_IMAGEWIDTH), height = field(file.get(), TIFFTAG_IMAGELENGTH);
    if (width < 1 || height < 1 || width > kMaxImageSide || height > kMaxImageSide) {
        throw request.error("claims " + std::to_string(width) + " x " + std::to_string(height) + " pixels; at most " +
                            std::to_string(kMaxImageSide) + " a side are read");
    }
    const int bits = small_field(file.get(), TIFFTAG_BITSPERSAMPLE);
    const int format = small_field(file.get(), TIFFTAG_SAMPLEFORMAT);
    const bool counts = bits == 16 && format == SAMPLEFORMAT_UINT;
    const bool real = bits == 32 && format == SAMPLEFORMAT_IEEEFP;
    if (small_field(file.get(), TIFFTAG_SAMPLESPERPIXEL) != 1 || !(counts || real) || TIFFIsTiled(file.get()) != 0) {
        throw request.error("has " + std::to_string(bits) + " bits a channel or more than one channel, or is tiled; " +
                            "depth must be one channel of 16-bit counts or 32-bit floating point numbers, in strips");
    }
    NumberImage image{static_cast<int>(width), static_cast<int>(height), real, {}};
    request.check_size({image.width, image.height});
    if (request.with_pixels) read_rows(file.get(), request, message, image);
    return image;
}

#else

NumberImage read_tiff(const DepthRequest& request) {
    throw request.error(
        "is a TIFF, and this program was built without libtiff (third_party_notes/install_packages.sh "
        "images, then build anew); or convert it to 16-bit PNG or NPY");
}

#endif

}  // namespace nearpose::data_set
