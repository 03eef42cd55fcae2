#include "apps/scenes/mask_errors.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "core/base/check.hpp"

namespace nearpose::simulate {
namespace {

constexpr int kMaxPixels = 1000;
// Neighbouring pixels whose depths differ by less than this fraction show surfaces that touch, or one steep surface.
constexpr float kTouching = 0.01F;

// Each value becomes the largest of those up to `radius` pixels before and after it in its line.
void dilate_line(const std::uint8_t* from, std::uint8_t* to, int count, int stride, int radius) {
    int last = -radius - 1;  // the last pixel of the mask that was met
    for (int i = 0; i < count; ++i) {
        if (from[i * stride] != 0) last = i;
        to[i * stride] = i - last <= radius ? 255 : 0;
    }
    last = count + radius;
    for (int i = count - 1; i >= 0; --i) {
        if (from[i * stride] != 0) last = i;
        if (last - i <= radius) to[i * stride] = 255;
    }
}

// By a square of `radius` pixels around each.
Mask dilated(const Mask& mask, int radius) {
    Mask rows = mask, result = mask;
    for (int v = 0; v < mask.height; ++v) {
        const std::size_t first = static_cast<std::size_t>(v) * mask.width;
        dilate_line(&mask.value[first], &rows.value[first], mask.width, 1, radius);
    }
    for (int u = 0; u < mask.width; ++u) dilate_line(&rows.value[u], &result.value[u], mask.height, mask.width, radius);
    return result;
}

Mask inverted(Mask mask) {
    for (std::uint8_t& value : mask.value) value = value != 0 ? 0 : 255;
    return mask;
}

// Step by step onto the neighbours, where no edge of depth is in between.
Mask bled(Mask mask, const DepthImage& depth, int steps) {
    for (int step = 0; step < steps; ++step) {
        const Mask before = mask;
        for (int v = 0; v < mask.height; ++v) {
            for (int u = 0; u < mask.width; ++u) {
                const std::size_t pixel = static_cast<std::size_t>(v) * mask.width + u;
                const float here = depth.depth_m[pixel];
                if (before.value[pixel] != 0 || !(here > 0.0F)) continue;
                const auto comes_from = [&](bool inside, std::size_t other) {
                    return inside && before.value[other] != 0 &&
                           std::abs(depth.depth_m[other] - here) < kTouching * here;
                };
                if (comes_from(u > 0, pixel - 1) || comes_from(u + 1 < mask.width, pixel + 1) ||
                    comes_from(v > 0, pixel - mask.width) || comes_from(v + 1 < mask.height, pixel + mask.width)) {
                    mask.value[pixel] = 255;
                }
            }
        }
    }
    return mask;
}

}  // namespace

void validate(const MaskErrors& errors) {
    check_option("mask.grow_pixels", errors.grow_pixels, -kMaxPixels, kMaxPixels);
    check_option("mask.bleed_pixels", errors.bleed_pixels, 0, kMaxPixels);
}

Mask with_errors(const Mask& exact, const RenderedImage& image, const MaskErrors& errors) {
    Mask mask = bled(exact, image.depth, errors.bleed_pixels);
    if (errors.grow_pixels > 0) mask = dilated(mask, errors.grow_pixels);
    if (errors.grow_pixels < 0) mask = inverted(dilated(inverted(std::move(mask)), -errors.grow_pixels));
    return mask;
}

}  // namespace nearpose::simulate
