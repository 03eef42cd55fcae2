#include "apps/scenes/pixel_moves.hpp"

#include <limits>

namespace nearpose::simulate {
namespace {

constexpr float kFar = std::numeric_limits<float>::infinity();

// The least of the values up to `radius` steps before and after in a line.
void least_of_line(const float* from, float* to, int count, int stride, int radius) {
    for (int i = 0; i < count; ++i) {
        float least = kFar;
        for (int j = std::max(0, i - radius); j <= std::min(count - 1, i + radius); ++j)
            least = std::min(least, from[static_cast<std::ptrdiff_t>(j) * stride]);
        to[static_cast<std::ptrdiff_t>(i) * stride] = least;
    }
}

}  // namespace

void shift_right(DepthImage& depth, int pixels) {
    const DepthImage before = depth;
    for (int v = 0; v < depth.height; ++v) {
        const std::size_t row = static_cast<std::size_t>(v) * depth.width;
        for (int u = 0; u < depth.width; ++u) {
            const int from = u - pixels;
            depth.depth_m[row + u] = from >= 0 && from < depth.width ? before.depth_m[row + from] : 0.0F;
        }
    }
}

void grow_near_surfaces(DepthImage& depth, int radius) {
    constexpr float kStep_m = 0.008F;
    std::vector<float> measured = depth.depth_m;
    for (float& value_m : measured) value_m = value_m > 0.0F ? value_m : kFar;
    std::vector<float> rows = measured, nearest = measured;
    for (int v = 0; v < depth.height; ++v) {
        const std::size_t row = static_cast<std::size_t>(v) * depth.width;
        least_of_line(&measured[row], &rows[row], depth.width, 1, radius);
    }
    for (int u = 0; u < depth.width; ++u) least_of_line(&rows[u], &nearest[u], depth.height, depth.width, radius);
    for (std::size_t pixel = 0; pixel < measured.size(); ++pixel) {
        const bool is_hole = measured[pixel] == kFar;
        if (!is_hole && nearest[pixel] < measured[pixel] - kStep_m) depth.depth_m[pixel] = nearest[pixel];
    }
}

void decimate(DepthImage& depth, int side) {
    std::vector<float> block;
    for (int first_v = 0; first_v < depth.height; first_v += side) {
        for (int first_u = 0; first_u < depth.width; first_u += side) {
            const int last_v = std::min(depth.height, first_v + side), last_u = std::min(depth.width, first_u + side);
            block.clear();
            for (int v = first_v; v < last_v; ++v) {
                const float* row = &depth.depth_m[static_cast<std::size_t>(v) * depth.width];
                std::copy_if(row + first_u, row + last_u, std::back_inserter(block), [](float d) { return d > 0.0F; });
            }
            if (block.empty()) continue;
            const auto middle = block.begin() + static_cast<std::ptrdiff_t>((block.size() - 1) / 2);
            std::nth_element(block.begin(), middle, block.end());
            for (int v = first_v; v < last_v; ++v) {
                float* row = &depth.depth_m[static_cast<std::size_t>(v) * depth.width];
                std::fill(row + first_u, row + last_u, *middle);
            }
        }
    }
}

void fill_from_left(DepthImage& depth) {
    for (std::size_t pixel = 0; pixel < depth.depth_m.size(); ++pixel) {
        float& value_m = depth.depth_m[pixel];
        if (!(value_m > 0.0F) && pixel % static_cast<std::size_t>(depth.width) != 0) value_m = depth.depth_m[pixel - 1];
    }
}

}  // namespace nearpose::simulate
