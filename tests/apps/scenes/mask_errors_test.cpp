#include "apps/scenes/mask_errors.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "core/base/random.hpp"

namespace nearpose::simulate {
namespace {

constexpr int kWidth = 31, kHeight = 23;

Mask speckled(std::uint64_t seed) {
    RandomStream random(seed, 0, 0, RandomPurpose::kStart);
    Mask mask{kWidth, kHeight, std::vector<std::uint8_t>(kWidth * kHeight, 0)};
    for (std::uint8_t& value : mask.value) value = random.uniform() < (seed % 2 == 0 ? 0.05 : 0.95) ? 255 : 0;
    return mask;
}

RenderedImage flat(float depth_m) {
    return {{kWidth, kHeight, std::vector<float>(kWidth * kHeight, depth_m)}, {}, {}};
}

// Whether any pixel of the value lies within `radius` in u and in v.
bool has_near(const Mask& mask, int u, int v, int radius, bool value) {
    for (int dv = -radius; dv <= radius; ++dv) {
        for (int du = -radius; du <= radius; ++du) {
            const int x = u + du, y = v + dv;
            if (x < 0 || y < 0 || x >= mask.width || y >= mask.height) continue;
            if ((mask.value[static_cast<std::size_t>(y) * mask.width + x] != 0) == value) return true;
        }
    }
    return false;
}

TEST(MaskErrors, GrowAndShrinkAsBruteForce) {
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
        const Mask mask = speckled(seed);
        for (const int radius : {1, 3, 40}) {
            const Mask grown = with_errors(mask, flat(1.0F), {radius, 0}),
                       shrunk = with_errors(mask, flat(1.0F), {-radius, 0});
            for (int v = 0; v < kHeight; ++v) {
                for (int u = 0; u < kWidth; ++u) {
                    const std::size_t pixel = static_cast<std::size_t>(v) * kWidth + u;
                    ASSERT_EQ(grown.value[pixel] != 0, has_near(mask, u, v, radius, true));
                    // What lies outside the image does not eat into the mask.
                    ASSERT_EQ(shrunk.value[pixel] == 0, has_near(mask, u, v, radius, false));
                }
            }
        }
        EXPECT_EQ(with_errors(mask, flat(1.0F), {}).value, mask.value);
    }
}

TEST(MaskErrors, BleedOntoWhatTouchesButNotOverEdges) {
    RenderedImage image = flat(0.5F);
    for (int v = 0; v < kHeight; ++v) {
        for (int u = 18; u < kWidth; ++u) image.depth.depth_m[static_cast<std::size_t>(v) * kWidth + u] = 0.53F;
        image.depth.depth_m[static_cast<std::size_t>(v) * kWidth + 9] = 0.0F;  // nothing there
    }
    Mask mask{kWidth, kHeight, std::vector<std::uint8_t>(kWidth * kHeight, 0)};
    for (int v = 8; v <= 12; ++v) {
        for (int u = 11; u <= 16; ++u) mask.value[static_cast<std::size_t>(v) * kWidth + u] = 255;
    }
    const Mask bled = with_errors(mask, image, {0, 4});
    for (int v = 0; v < kHeight; ++v) {
        for (int u = 0; u < kWidth; ++u) {
            // As many steps from neighbour to neighbour, on this side of both edges.
            const int du = std::max({0, 11 - u, u - 16}), dv = std::max({0, 8 - v, v - 12});
            const bool expected = u > 9 && u < 18 && du + dv <= 4;
            ASSERT_EQ(bled.value[static_cast<std::size_t>(v) * kWidth + u] != 0, expected) << u << " " << v;
        }
    }
}

TEST(MaskErrors, RefuseBounds) {
    EXPECT_THROW(validate(MaskErrors{0, -1}), std::invalid_argument);
    EXPECT_THROW(validate(MaskErrors{5000, 0}), std::invalid_argument);
}

}  // namespace
}  // namespace nearpose::simulate
