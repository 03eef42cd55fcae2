// Laws of depth by stereo matching, on cards that stand upright across the camera's axis.
#include "apps/depth_sensor/stereo_sensor.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/base/parallel.hpp"
#include "tests/apps/depth_sensor/stereo_cards.hpp"

namespace nearpose::simulate {
namespace {

class StereoSensor : public testing::Test {
  protected:
    void SetUp() override {
        if (!stereo_is_built()) GTEST_SKIP() << "built without OpenCV: no stereo matching";
    }
};

TEST_F(StereoSensor, APlaneComesBackAtItsDepth) {
    for (const double depth_m : {0.31, 0.5, 0.77}) {
        const DepthImage image = measured({{depth_m}}, test_rig());
        const int first_u = static_cast<int>(disparity_at(depth_m)) + 5;  // what the right camera sees too
        const std::vector<double> errors = disparity_errors(image, depth_m, first_u, kCamera.width - 5);
        EXPECT_GT(share_at(image, depth_m, first_u, kCamera.width - 5), 0.97) << depth_m;
        EXPECT_NEAR(quantile(errors, 0.5), 0.0, 2.0 / 16) << depth_m;
        EXPECT_LT(quantile(errors, 0.95) - quantile(errors, 0.05), 1.0) << depth_m;
    }
}

// The matcher draws disparities towards whole pixels (pixel locking), so the error is taken over all fractions of one.
TEST_F(StereoSensor, TheErrorOfDisparityIsTheSameFarAndNearSoDepthsGrowsWithItsSquare) {
    const auto error_pixels = [](int whole_disparity) {
        double squares = 0.0;
        std::size_t count = 0;
        for (const double fraction : {0.0, 0.2, 0.4, 0.6, 0.8}) {
            const double depth_m = disparity_at(1.0) / (whole_disparity + fraction);
            for (const double error :
                 disparity_errors(measured({{depth_m}}, test_rig()), depth_m, 60, kCamera.width - 10)) {
                squares += std::min(1.0, error * error);
                ++count;
            }
        }
        return std::sqrt(squares / static_cast<double>(count));
    };
    const double far = error_pixels(18), near = error_pixels(36);
    EXPECT_GT(far, 0.03);
    EXPECT_LT(far, 0.3);
    EXPECT_NEAR(near / far, 1.0, 0.35);
}

TEST_F(StereoSensor, WhatOnlyOneCameraSeesHasNoDepth) {
    // The card's left edge is at u = 150. On its left the right camera sees less of the wall by the difference of the
    // disparities, 30 pixels; on its right it sees all.
    const Card card{0.3, 0.3 * (150.0 - kCamera.cx) / kCamera.fx, 0.3 * (220.0 - kCamera.cx) / kCamera.fx};
    const DepthImage image = measured({{0.75}, card}, test_rig());
    EXPECT_LT(share_at(image, 0.75, 125, 145), 0.1);
    EXPECT_GT(share_at(image, 0.75, 60, 110), 0.95);
    EXPECT_GT(share_at(image, 0.75, 232, 310), 0.95);
    // Nor does the border that lies outside the right image.
    EXPECT_LT(share_at(image, 0.75, 0, 18), 0.05);
}

TEST_F(StereoSensor, NearObjectsGrowByUpToHalfAWindow) {
    const double right_u = 220.0;
    const Card card{0.3, 0.3 * (150.0 - kCamera.cx) / kCamera.fx, 0.3 * (right_u - kCamera.cx) / kCamera.fx};
    const auto growth_pixels = [&](int window) {
        StereoRig rig = test_rig();
        rig.window_pixels = window;
        const DepthImage image = measured({{0.75}, card}, rig);
        return share_at(image, 0.3, static_cast<int>(right_u) + 1, static_cast<int>(right_u) + 21) * 20.0;
    };
    const double narrow = growth_pixels(5), wide = growth_pixels(15);
    EXPECT_GT(narrow, 0.2);
    EXPECT_LT(narrow, 4.0);
    EXPECT_GT(wide, narrow + 1.0);
    EXPECT_LT(wide, 9.0);
}

TEST_F(StereoSensor, SurfacesWithoutTextureHaveNoDepth) {
    StereoRig rig = test_rig();
    rig.dots = 0;
    const DepthImage image = measured({{0.5}}, rig);
    EXPECT_LT(share_at(image, 0.5, 40, 310), 0.1);
}

TEST_F(StereoSensor, MeasuresOnlyWithinItsRange) {
    StereoRig rig = test_rig();
    rig.max_range_m = 0.45;
    for (const float depth_m : measured({{0.5}}, rig).depth_m) ASSERT_LE(depth_m, 0.45F);
    EXPECT_LT(share_at(measured({{0.5}}, rig), 0.5, 40, 310), 0.01);
}

TEST_F(StereoSensor, SeedAndFrameNameTheDrawsForAnyNumberOfThreads) {
    const std::vector<Card> scene{{0.6}, {0.4, -0.05, 0.05}};
    const auto frames = [&](std::uint64_t seed, int num_threads) {
        std::vector<DepthImage> images(3);
        parallel_for(3, num_threads, [&](int frame) {
            images[static_cast<std::size_t>(frame)] =
                measured(scene, test_rig(), seed, static_cast<std::uint64_t>(frame));
        });
        return images;
    };
    const std::vector<DepthImage> one = frames(1, 1), three = frames(1, 3);
    for (std::size_t i = 0; i < one.size(); ++i) EXPECT_EQ(one[i].depth_m, three[i].depth_m);
    EXPECT_NE(one[0].depth_m, one[1].depth_m);
    EXPECT_NE(one[0].depth_m, measured(scene, test_rig(), 2).depth_m);
}

TEST(StereoMatcher, SaysWhatToInstallWhereItIsMissing) {
    if (stereo_is_built()) GTEST_SKIP() << "built with OpenCV";
    try {
        require_stereo();
        FAIL();
    } catch (const std::runtime_error& error) {
        EXPECT_NE(std::string(error.what()).find("install_packages.sh stereo"), std::string::npos) << error.what();
    }
}

TEST(InfraredImages, NoiseIsAnotherInEveryFrameAndTheDotsAreNot) {
    StereoRig rig = test_rig();
    const auto left = [&](std::uint64_t seed, std::uint64_t frame) {
        return infrared_images(cards({{0.5}}), kCamera, rig, {}, 1, seed, frame).left.value;
    };
    EXPECT_EQ(left(1, 0), left(1, 0));
    EXPECT_NE(left(1, 0), left(1, 1));
    rig.infrared_sigma_grey = 0.0;
    EXPECT_EQ(left(1, 0), left(1, 1));
    EXPECT_NE(left(1, 0), left(2, 0));
}

TEST(InfraredImages, AreExposedForWhatIsThere) {
    const auto level = [](double depth_m, const Material& material) {
        const GreyImage image = infrared_images(cards({{depth_m}}), kCamera, test_rig(), material, 1, 1, 0).left;
        return quantile(std::vector<double>(image.value.begin(), image.value.end()), 0.95);
    };
    for (const double depth_m : {0.2, 0.5, 1.0})
        for (const std::string& name : material_names())
            EXPECT_NEAR(level(depth_m, material_of(name)), 200.0, 12.0) << depth_m << name;
}

TEST(InfraredImages, PolishedSurfacesShineInTheMirrorDirection) {
    StereoRig rig = test_rig();
    rig.infrared_sigma_grey = 0.0;
    rig.dot_sigma_tan = 0.05;  // even light
    rig.ambient = 0.0;
    // A mirror throws the projector's light back half way between it and the left camera: at u = 168.5.
    const auto ratio = [&](const char* material) {
        const GreyImage image = infrared_images(cards({{0.5}}), kCamera, rig, material_of(material), 1, 1, 0).left;
        const auto mean = [&](int first_u) {
            double sum = 0.0;
            for (int v = 100; v < 140; ++v)
                for (int u = first_u; u < first_u + 40; ++u)
                    sum += image.value[static_cast<std::size_t>(v * kCamera.width + u)];
            return sum / 1600.0;
        };
        return mean(148) / mean(270);
    };
    EXPECT_GT(ratio("machined_aluminium"), 1.3 * ratio("cast_iron"));
}

TEST(DotProjector, ThrowsAShadowAndFallsOffWithTheSquareOfTheDistance) {
    StereoRig rig = test_rig();
    rig.dot_sigma_tan = 0.1;  // so wide that the light is even
    const Card card{0.3, -0.05, 0.05};
    const DotProjector projector(cards({{0.6}, card}), kCamera, rig, 1);
    // Edges of the card's shadow on the wall, twice as far from the projector.
    const double left_m = rig.projector_m + 2.0 * (card.left_m - rig.projector_m),
                 right_m = rig.projector_m + 2.0 * (card.right_m - rig.projector_m), margin_m = 0.004;
    const auto light = [&](double x_m, double depth_m) { return projector.light_at({x_m, 0.01, depth_m}); };
    EXPECT_GT(light(left_m - margin_m, 0.6), 0.0);
    EXPECT_EQ(light(left_m + margin_m, 0.6), 0.0);
    EXPECT_EQ(light(right_m - margin_m, 0.6), 0.0);
    EXPECT_GT(light(right_m + margin_m, 0.6), 0.0);
    EXPECT_GT(light(card.left_m + 0.001, 0.3), 0.0);
    // On the same ray, at half the distance.
    const Eigen::Vector3d beside = projector.position_in_left() + Eigen::Vector3d(-0.2, 0.0, 0.6);
    const Eigen::Vector3d half = projector.position_in_left() + Eigen::Vector3d(-0.1, 0.0, 0.3);
    EXPECT_NEAR(projector.light_at(half) / projector.light_at(beside), 4.0, 1e-9);
}

TEST(Materials, AreKnownByName) {
    for (const std::string& name : material_names()) EXPECT_GT(material_of(name).albedo, 0.0);
    try {
        material_of("wood");
        FAIL();
    } catch (const std::invalid_argument& error) {
        EXPECT_NE(std::string(error.what()).find("cast_iron"), std::string::npos) << error.what();
    }
}

}  // namespace
}  // namespace nearpose::simulate
