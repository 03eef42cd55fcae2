// Images whose pixels come from other places of the same image.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "core/base/depth_image.hpp"

namespace nearpose::simulate {

// Row-major values turned clockwise by 90, 180 or 270 degrees. The size stays, so quarter turns need a square image.
template <typename Value>
std::vector<Value> turned(const std::vector<Value>& values, int width, int height, int degrees) {
    if (degrees == 180) return {values.rbegin(), values.rend()};
    std::vector<Value> result(values.size());
    for (int v = 0; v < height; ++v) {
        for (int u = 0; u < width; ++u) {
            const int from_u = degrees == 90 ? v : width - 1 - v, from_v = degrees == 90 ? height - 1 - u : u;
            result[static_cast<std::size_t>(v) * width + u] = values[static_cast<std::size_t>(from_v) * width + from_u];
        }
    }
    return result;
}

// Left for right.
template <typename Value>
void mirror(std::vector<Value>& values, int width) {
    for (auto row = values.begin(); row != values.end(); row += width) std::reverse(row, row + width);
}

// By whole pixels; negative: to the left. What comes in from the side has no depth.
void shift_right(DepthImage& depth, int pixels);

// A pixel takes the nearest depth of the square of `radius` pixels around it where that is nearer by more than 8 mm,
// as between two surfaces and not along one. Holes stay.
void grow_near_surfaces(DepthImage& depth, int radius);

// Each block of `side` x `side` pixels, of the last ones what is left, has the median of its depths (of two middle ones
// the nearer) in all its pixels; blocks without depth stay holes.
void decimate(DepthImage& depth, int side);

// Each hole takes the depth to its left; those at the left border stay.
void fill_from_left(DepthImage& depth);

}  // namespace nearpose::simulate
