// The readers behind depth_file.hpp, private to it. Each reads the header, checks it, calls `check_size`, which throws
// for a size that is not wanted, and reads the pixels where `with_pixels`.
#pragma once

#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>

#include "apps/data_set/depth_file.hpp"

namespace nearpose::data_set {

struct DepthRequest {
    std::filesystem::path path;
    bool with_pixels = true;
    std::function<void(ImageSize)> check_size;

    std::runtime_error error(const std::string& problem) const {
        return std::runtime_error(path.string() + ": " + problem);
    }
};

// Two dimensions, little or big endian: uint8, int16, uint16, int32, uint32, float16 not, float32, float64.
NumberImage read_npy(const DepthRequest& request);
// One channel of 16-bit counts or 32-bit floating point numbers, in strips.
NumberImage read_tiff(const DepthRequest& request);
// The channel Z, or the only one.
NumberImage read_exr(const DepthRequest& request);

}  // namespace nearpose::data_set
