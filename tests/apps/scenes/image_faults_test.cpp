#include "apps/scenes/image_faults.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/base/random.hpp"

namespace nearpose::simulate {
namespace {

constexpr int kWidth = 48, kHeight = 36;
constexpr PinholeCamera kLens{kWidth, kHeight, 40.0, 40.0, 23.5, 17.5};

// A tilted plane before a far wall, with holes; its own exact image.
RenderedImage some_image(int width = kWidth, int height = kHeight) {
    RenderedImage image;
    image.depth = {width, height, {}};
    RandomStream random(3, 0, 0, RandomPurpose::kStart);
    for (int v = 0; v < height; ++v) {
        for (int u = 0; u < width; ++u) {
            const bool near = u > width / 4 && u < width / 2;
            const bool hole = random.uniform() < 0.05;
            image.depth.depth_m.push_back(hole ? 0.0F : (near ? 0.4F + 0.001F * static_cast<float>(v) : 0.9F));
        }
    }
    image.normals_in_camera.assign(image.depth.depth_m.size(), -Eigen::Vector3f::UnitZ());
    return image;
}

struct Faulted {
    DepthImage depth;
    Mask mask;
};

Faulted with(const std::string& fault, const RenderedImage& image, int frame = 0, std::uint64_t seed = 1) {
    const DepthImage& depth = image.depth;
    Faulted result{depth, {depth.width, depth.height, {}}};
    for (const float value_m : depth.depth_m) result.mask.value.push_back(value_m < 0.5F ? 255 : 0);
    apply_fault(parse_fault(fault + "@all"), {image, kLens, 0.1, 4.0, seed, frame, 0}, result.depth, result.mask);
    return result;
}

std::vector<float> faulted(const std::string& fault, const RenderedImage& image, int frame = 0) {
    return with(fault, image, frame).depth.depth_m;
}

double share_changed(const std::vector<float>& a, const std::vector<float>& b) {
    int count = 0;
    for (std::size_t i = 0; i < a.size(); ++i) count += a[i] != b[i] ? 1 : 0;
    return count / static_cast<double>(a.size());
}

TEST(ImageFaults, TurnsAndMirrorsAreUndoneByTheirLike) {
    const RenderedImage image = some_image();
    for (const auto& [fault, times] : {std::pair{"mirrored", 2}, {"rotated:180", 2}}) {
        RenderedImage turned = image;
        for (int i = 0; i < times; ++i) {
            turned.depth = with(fault, turned).depth;
            EXPECT_EQ(turned.depth.depth_m == image.depth.depth_m, i + 1 == times) << fault << i;
        }
    }
    const RenderedImage square = some_image(kHeight, kHeight);
    RenderedImage quarter = square;
    quarter.depth = with("rotated:90", square).depth;
    EXPECT_EQ(quarter.depth.depth_m[kHeight - 1], square.depth.depth_m[0]);  // clockwise: the first row's last pixel
    EXPECT_EQ(faulted("rotated:90", quarter), faulted("rotated:180", square));
    EXPECT_EQ(faulted("rotated:270", quarter), square.depth.depth_m);
}

TEST(ImageFaults, MasksTurnWithTheImageAndDoNotShift) {
    const RenderedImage image = some_image();
    for (const char* fault : {"mirrored", "rotated:180"}) {
        const Faulted turned = with(fault, image);
        for (std::size_t i = 0; i < turned.mask.value.size(); ++i)
            EXPECT_EQ(turned.mask.value[i] != 0, turned.depth.depth_m[i] < 0.5F) << fault;
    }
    EXPECT_EQ(with("shift:5", image).mask.value, with("quantised:1", image).mask.value);
}

TEST(ImageFaults, AShiftMovesColumnsAndBringsInHoles) {
    const RenderedImage image = some_image();
    for (const int pixels : {7, -7}) {
        const std::vector<float> shifted = faulted("shift:" + std::to_string(pixels), image);
        for (int v = 0; v < kHeight; ++v) {
            for (int u = 0; u < kWidth; ++u) {
                const int from = u - pixels;
                const bool is_in = from >= 0 && from < kWidth;
                EXPECT_EQ(shifted[v * kWidth + u], is_in ? image.depth.depth_m[v * kWidth + from] : 0.0F);
            }
        }
    }
}

TEST(ImageFaults, NearSurfacesGrowByTheRadiusOverFarOnesAlone) {
    RenderedImage image = some_image();
    for (std::size_t i = 0; i < image.depth.depth_m.size(); ++i) {
        const std::size_t u = i % kWidth;
        image.depth.depth_m[i] =
            u > kWidth / 4 && u < kWidth / 2 ? 0.4F + 0.001F * static_cast<float>(i / kWidth) : 0.9F;
    }
    const std::vector<float> grown = faulted("edges:3", image);
    for (int v = 0; v < kHeight; ++v) {
        for (int u = 0; u < kWidth; ++u) {
            const bool near = u > kWidth / 4 - 3 && u < kWidth / 2 + 3;
            const bool was_near = u > kWidth / 4 && u < kWidth / 2;
            EXPECT_EQ(grown[v * kWidth + u] < 0.5F, near) << u;
            if (was_near) {
                EXPECT_EQ(grown[v * kWidth + u], image.depth.depth_m[v * kWidth + u]);
            }
        }
    }
}

TEST(ImageFaults, RowsAreMissingWholeAndInAboutThreeOfTen) {
    RenderedImage image = some_image(40, 600);
    image.depth.depth_m.assign(image.depth.depth_m.size(), 0.5F);
    const std::vector<float> some = faulted("rows-missing", image);
    int missing = 0;
    for (int v = 0; v < 600; ++v) {
        for (int u = 1; u < 40; ++u) EXPECT_EQ(some[v * 40 + u], some[v * 40]);
        missing += some[v * 40] == 0.0F ? 1 : 0;
    }
    EXPECT_NEAR(missing / 600.0, 0.3, 0.15);
    EXPECT_NE(some, faulted("rows-missing", image, 1));
}

TEST(ImageFaults, SharesAreThoseAskedFor) {
    RenderedImage image = some_image(200, 200);
    image.depth.depth_m.assign(image.depth.depth_m.size(), 0.5F);
    for (const double share : {0.0, 0.1, 0.4}) {
        const std::string text = ":" + std::to_string(share);
        EXPECT_NEAR(share_changed(faulted("salt-pepper" + text, image), image.depth.depth_m), share, 0.02);
        EXPECT_NEAR(share_changed(faulted("holes" + text, image), image.depth.depth_m), share, 1e-9);
        EXPECT_NEAR(share_changed(faulted("exposure-holes" + text, image), image.depth.depth_m), share, 1e-9);
    }
    int near = 0, far = 0;
    for (const float value_m : faulted("salt-pepper:1", image)) {
        near += value_m == 0.1F ? 1 : 0;
        far += value_m == 4.0F ? 1 : 0;
    }
    EXPECT_EQ(near + far, 200 * 200);
    EXPECT_NEAR(near / 4e4, 0.5, 0.02);
}

TEST(ImageFaults, ExposureTakesTheNearestFirst) {
    const RenderedImage image = some_image();
    const std::vector<float> exposed = faulted("exposure-holes:0.2", image);
    for (std::size_t i = 0; i < exposed.size(); ++i) {
        if (image.depth.depth_m[i] > 0.5F) {
            EXPECT_EQ(exposed[i], image.depth.depth_m[i]);
        }
    }
    EXPECT_GT(share_changed(exposed, image.depth.depth_m), 0.15);
}

TEST(ImageFaults, AHandIsNearerThanAllElseAndNotInTheMask) {
    const RenderedImage image = some_image();
    const Faulted hand = with("hand", image);
    for (std::size_t i = 0; i < hand.depth.depth_m.size(); ++i) {
        if (hand.depth.depth_m[i] == image.depth.depth_m[i]) continue;
        EXPECT_LT(hand.depth.depth_m[i], 0.4F);
        EXPECT_GE(hand.depth.depth_m[i], 0.1F);
        EXPECT_EQ(hand.mask.value[i], 0);
    }
    EXPECT_NEAR(share_changed(hand.depth.depth_m, image.depth.depth_m), 0.2, 0.1);
    EXPECT_NE(faulted("hand", image, 5), hand.depth.depth_m);
}

TEST(ImageFaults, DepthIsScaledSteppedAndWavedPixelByPixel) {
    const RenderedImage image = some_image();
    const std::vector<float>& exact = image.depth.depth_m;
    const std::vector<float> scaled = faulted("depth-scale:3", image), steps = faulted("quantised:10", image),
                             waves = faulted("waves:5", image);
    double most = 0.0;
    for (std::size_t i = 0; i < exact.size(); ++i) {
        EXPECT_EQ(scaled[i], static_cast<float>(static_cast<double>(exact[i]) * 1.03));
        EXPECT_NEAR(std::remainder(steps[i], 0.01), 0.0, 1e-6);
        EXPECT_NEAR(steps[i], exact[i], 0.005 + 1e-6);
        EXPECT_EQ(exact[i] == 0.0F, scaled[i] == 0.0F && steps[i] == 0.0F && waves[i] == 0.0F);
        EXPECT_NEAR(waves[i], exact[i], 0.005 + 1e-6);
        most = std::max(most, std::abs(static_cast<double>(waves[i]) - exact[i]));
    }
    EXPECT_GT(most, 0.0049);
}

TEST(ImageFaults, BlocksHaveTheMedianOfTheirDepths) {
    RenderedImage image = some_image(5, 4);
    image.depth.depth_m = {0.5F, 0.7F, 0.0F, 0.0F, 0.3F,  //
                           0.6F, 0.9F, 0.0F, 0.0F, 0.2F,  //
                           0.0F, 0.8F, 0.1F, 0.2F, 0.0F,  //
                           0.0F, 0.0F, 0.3F, 0.4F, 0.5F};
    EXPECT_EQ(faulted("decimation:2", image), (std::vector<float>{0.6F, 0.6F, 0.0F, 0.0F, 0.2F,  //
                                                                  0.6F, 0.6F, 0.0F, 0.0F, 0.2F,  //
                                                                  0.8F, 0.8F, 0.2F, 0.2F, 0.5F,  //
                                                                  0.8F, 0.8F, 0.2F, 0.2F, 0.5F}));
    EXPECT_EQ(faulted("decimation:1", image), image.depth.depth_m);
    EXPECT_EQ(faulted("hole-filling", image), (std::vector<float>{0.5F, 0.7F, 0.7F, 0.7F, 0.3F,  //
                                                                  0.6F, 0.9F, 0.9F, 0.9F, 0.2F,  //
                                                                  0.0F, 0.8F, 0.1F, 0.2F, 0.2F,  //
                                                                  0.0F, 0.0F, 0.3F, 0.4F, 0.5F}));
}

TEST(ImageFaults, TheTemporalFilterMixesSmallStepsAndFillsHoles) {
    const DepthImage before{4, 1, {0.500F, 0.500F, 0.500F, 0.0F}}, now{4, 1, {0.510F, 0.530F, 0.0F, 0.7F}};
    const DepthImage mixed = temporally_filtered(before, now, 0.25);
    EXPECT_FLOAT_EQ(mixed.depth_m[0], 0.5025F);
    EXPECT_EQ(mixed.depth_m[1], 0.530F);
    EXPECT_EQ(mixed.depth_m[2], 0.500F);
    EXPECT_EQ(mixed.depth_m[3], 0.7F);
    const DepthImage alone = temporally_filtered(before, now, 1.0);  // changes nothing that was measured
    EXPECT_EQ(alone.depth_m, (std::vector<float>{0.510F, 0.530F, 0.500F, 0.7F}));
    EXPECT_EQ(temporally_filtered(before, before, 0.3).depth_m, before.depth_m);
}

TEST(ImageFaults, TheMemoryLivesAsLongAsTheFault) {
    const RenderedImage image = some_image();
    const std::vector<Fault> faults{parse_fault("depth-scale:1@2"), parse_fault("temporal-filter:0.5@1-2")};
    FaultMemory memory;
    const auto next = [&](int frame) {
        DepthImage depth = image.depth;
        Mask mask{kWidth, kHeight, std::vector<std::uint8_t>(depth.depth_m.size(), 0)};
        apply_faults(faults, {image, kLens, 0.1, 4.0, 1, frame, 0}, memory, depth, mask);
        return depth.depth_m;
    };
    for (const int frame : {0, 1}) {
        EXPECT_EQ(next(frame), image.depth.depth_m);
        EXPECT_EQ(memory.size(), frame == 1 ? 1U : 0U);
    }
    const std::vector<float> second = next(2);
    for (std::size_t i = 0; i < second.size(); ++i) EXPECT_NEAR(second[i], 1.005 * image.depth.depth_m[i], 1e-6);
    EXPECT_EQ(next(3), image.depth.depth_m);
    EXPECT_TRUE(memory.empty());
}

}  // namespace
}  // namespace nearpose::simulate
