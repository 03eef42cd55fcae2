// Laws of depth by structured light: one image, matched with the pattern that the projector throws.
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "apps/depth_sensor/stereo_sensor.hpp"
#include "core/base/parallel.hpp"
#include "tests/apps/depth_sensor/stereo_cards.hpp"

namespace nearpose::simulate {
namespace {

StereoRig light_rig() {
    StereoRig rig = test_rig();
    rig.structured_light = true;
    rig.projector_m = rig.baseline_m;
    rig.projector_width_tan = 1.6;
    rig.penalty_step = 0;
    rig.penalty_jump = 1;
    rig.window_pixels = 7;
    return rig;
}

// The card's edges are at u = 150 and u = 220.
const Card kNearCard{0.3, 0.3 * (150.0 - kCamera.cx) / kCamera.fx, 0.3 * (220.0 - kCamera.cx) / kCamera.fx};

// Mean length of the gap without depth that holds the column u, over the rows of the image's middle; 0 where it has
// depth.
double gap_pixels(const DepthImage& image, int u) {
    const int first_v = 60, last_v = 180;
    double sum = 0.0;
    for (int v = first_v; v < last_v; ++v) {
        const auto empty = [&](int column) {
            return column >= 0 && column < image.width &&
                   image.depth_m[static_cast<std::size_t>(v * image.width + column)] == 0.0F;
        };
        if (!empty(u)) continue;
        int left = u, right = u;
        while (empty(left - 1)) --left;
        while (empty(right + 1)) ++right;
        sum += right - left + 1;
    }
    return sum / (last_v - first_v);
}

class StructuredLight : public testing::Test {
  protected:
    void SetUp() override {
        if (!stereo_is_built()) GTEST_SKIP() << "built without OpenCV: no matching";
    }
};

// The matcher draws disparities towards whole pixels (pixel locking); the error of one depth is within a sixth, and
// that of all fractions of a pixel together within a twentieth.
TEST_F(StructuredLight, APlaneComesBackAtItsDepthOverTheWholeImage) {
    double mean = 0.0;
    for (const double disparity : {20.0, 20.2, 30.4, 30.6, 40.8}) {
        const double depth_m = disparity_at(1.0) / disparity;
        const DepthImage image = measured({{depth_m}}, light_rig());
        const double error = quantile(disparity_errors(image, depth_m, 8, kCamera.width - 8), 0.5);
        // The pattern goes on beyond the image's left border: no column is blind.
        EXPECT_GT(share_at(image, depth_m, 8, kCamera.width - 8), 0.97) << disparity;
        EXPECT_LT(std::abs(error), 1.0 / 6) << disparity;
        mean += error / 5.0;
    }
    EXPECT_NEAR(mean, 0.0, 0.05);
}

// The projector stands to the right, so the shadow lies to the left; its width is the difference of the disparities,
// but for what the card grows or loses at its edges: up to half a window.
TEST_F(StructuredLight, ACardThrowsItsShadowToOneSideAlone) {
    const StereoRig rig = light_rig();
    for (const double wall_m : {0.45, 0.75}) {
        const DepthImage image = measured({{wall_m}, kNearCard}, rig);
        const double shadow = disparity_at(kNearCard.depth_m) - disparity_at(wall_m);
        const int middle = 150 - static_cast<int>(0.5 * shadow);
        const double half_window = 0.5 * rig.window_pixels;
        EXPECT_NEAR(gap_pixels(image, middle), shadow, half_window) << wall_m;
        for (int u = 216; u < 230; ++u) EXPECT_LT(gap_pixels(image, u), half_window) << wall_m << " " << u;
        EXPECT_GT(share_at(image, kNearCard.depth_m, 156, 214), 0.97);
        EXPECT_GT(share_at(image, wall_m, 230, 310), 0.97);
    }
}

TEST_F(StructuredLight, WithoutDotsThereIsNoDepth) {
    StereoRig rig = light_rig();
    rig.dots = 0;
    EXPECT_LT(share_at(measured({{0.5}}, rig), 0.5, 8, 310), 0.05);
}

TEST_F(StructuredLight, SeedAndFrameNameTheDrawsForAnyNumberOfThreads) {
    const auto frames = [&](int num_threads) {
        std::vector<DepthImage> images(3);
        parallel_for(3, num_threads, [&](int frame) {
            images[static_cast<std::size_t>(frame)] =
                measured({{0.6}, kNearCard}, light_rig(), 1, static_cast<std::uint64_t>(frame));
        });
        return images;
    };
    const std::vector<DepthImage> one = frames(1), three = frames(3);
    for (std::size_t i = 0; i < one.size(); ++i) EXPECT_EQ(one[i].depth_m, three[i].depth_m);
    EXPECT_NE(one[0].depth_m, one[1].depth_m);
    EXPECT_NE(one[0].depth_m, measured({{0.6}, kNearCard}, light_rig(), 2).depth_m);
}

TEST_F(StructuredLight, RefusesAReferenceThatDoesNotFit) {
    const StereoRig rig = light_rig();
    InfraredPair images = infrared_images(cards({{0.5}}), kCamera, rig, {}, 1, 1, 0);
    images.right = {kCamera.width - 1, kCamera.height, {}};
    EXPECT_THROW(depth_of(images, kCamera, rig), std::invalid_argument);
}

TEST(ReferenceImage, IsThePatternWhateverTheSceneAndTheFrame) {
    const StereoRig rig = light_rig();
    const auto images = [&](const std::vector<Card>& scene, std::uint64_t seed, std::uint64_t frame) {
        return infrared_images(cards(scene), kCamera, rig, {}, 1, seed, frame);
    };
    const InfraredPair wall = images({{0.5}}, 1, 0), card = images({{0.75}, kNearCard}, 1, 7);
    EXPECT_EQ(wall.right.value, card.right.value);
    EXPECT_NE(wall.left.value, card.left.value);
    EXPECT_NE(wall.right.value, images({{0.5}}, 2, 0).right.value);
    // As many columns more as disparities are tried.
    EXPECT_EQ(wall.right.width - wall.left.width, std::lround(disparity_at(rig.min_range_m)));
}

TEST(StructuredLightRig, HasItsProjectorWhereThePatternIsSeenFrom) {
    StereoRig rig = light_rig();
    EXPECT_NO_THROW(validate(rig));
    rig.projector_m = 0.03;
    try {
        validate(rig);
        FAIL();
    } catch (const std::invalid_argument& error) {
        EXPECT_NE(std::string(error.what()).find("structured_light.projector_m is 0.03"), std::string::npos);
    }
}

}  // namespace
}  // namespace nearpose::simulate
