// Depth images of any format that is read: PNG, NPY and, where their libraries were there at build time, TIFF and EXR.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "apps/data_set/png_file.hpp"
#include "core/base/depth_image.hpp"

namespace nearpose::data_set {

// Row-major numbers as they stand in the file, before any scale.
struct NumberImage {
    int width = 0;              // [pixels]
    int height = 0;             // [pixels]
    bool real = false;          // the file holds floating point numbers, not counts
    std::vector<float> values;  // empty where only the size was asked for
};

// The size alone, from the header. As all of these it goes by the file's first bytes, whatever its name, and throws
// std::runtime_error naming the file and the cause.
ImageSize read_depth_size(const std::filesystem::path& path);

// Depth in metres: number * depth_scale_mm / 1000; what is not positive and finite becomes 0, no measurement. Without a
// depth_scale counts are millimetres, as in BOP, and floating point numbers metres. An image of another size than
// expected is refused before its pixels are read.
DepthImage read_depth_file(const std::filesystem::path& path, std::optional<double> depth_scale_mm, ImageSize expected);

}  // namespace nearpose::data_set
