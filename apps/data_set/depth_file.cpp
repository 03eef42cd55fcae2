#include "apps/data_set/depth_file.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <string_view>

#include "apps/base/file_io.hpp"
#include "apps/base/number_text.hpp"
#include "apps/data_set/depth_readers.hpp"

namespace nearpose::data_set {
namespace {

using namespace std::string_view_literals;

constexpr double kMillimetresOfMetre = 1000.0;

using Reader = NumberImage (*)(const DepthRequest&);

// The reader that a file's first bytes ask for; null for a PNG, and for what is none of them: the PNG reader says so.
Reader reader_of(const std::filesystem::path& path) {
    const std::string start = read_file_start(path, 8);
    if (start.starts_with("\x93NUMPY"sv)) return read_npy;
    for (const std::string_view mark : {"II*\0"sv, "MM\0*"sv, "II+\0"sv, "MM\0+"sv}) {
        if (start.starts_with(mark)) return read_tiff;
    }
    if (start.starts_with("\x76\x2f\x31\x01"sv)) return read_exr;
    return nullptr;
}

std::string sides_text(ImageSize size) {
    return std::to_string(size.width) + " x " + std::to_string(size.height);
}

}  // namespace

ImageSize read_depth_size(const std::filesystem::path& path) {
    const Reader reader = reader_of(path);
    if (reader == nullptr) return read_png_size(path);
    const NumberImage image = reader({path, false, [](ImageSize) {}});
    return {image.width, image.height};
}

DepthImage read_depth_file(const std::filesystem::path& path, std::optional<double> depth_scale_mm,
                           ImageSize expected) {
    const Reader reader = reader_of(path);
    if (reader == nullptr) {
        return read_depth_png(path, depth_scale_mm.value_or(1.0), expected.width, expected.height);
    }
    const auto check_size = [&](ImageSize size) {
        if (size == expected) return;
        throw std::runtime_error(path.string() + ": has " + sides_text(size) + " pixels, but " + sides_text(expected) +
                                 " are expected");
    };
    const NumberImage image = reader({path, true, check_size});
    const double scale_mm = depth_scale_mm.value_or(image.real ? kMillimetresOfMetre : 1.0);
    DepthImage depth{image.width, image.height, std::vector<float>(image.values.size())};
    std::transform(image.values.begin(), image.values.end(), depth.depth_m.begin(), [&](float value) {
        const double depth_m = value * scale_mm * 1e-3;
        return depth_m > 0.0 && std::isfinite(depth_m) ? static_cast<float>(depth_m) : 0.0F;
    });
    return depth;
}

}  // namespace nearpose::data_set
