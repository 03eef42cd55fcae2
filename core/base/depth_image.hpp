// Organised measurements: depth, mask.
#pragma once

#include <cstdint>
#include <vector>

namespace nearpose {

// Row-major depth along the optical axis [m]; 0 or NaN means no measurement.
struct DepthImage {
    int width = 0;   // [pixels]
    int height = 0;  // [pixels]
    std::vector<float> depth_m;
};

// Row-major; any value but 0 marks a pixel of the object.
struct Mask {
    int width = 0;   // [pixels]
    int height = 0;  // [pixels]
    std::vector<std::uint8_t> value;
};

}  // namespace nearpose
