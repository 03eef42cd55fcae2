// Laws of edge growth, on a card before a wall.
#include "apps/fit_sensor/edge_growth.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "apps/depth_sensor/sensor_noise.hpp"
#include "tests/apps/depth_sensor/stereo_cards.hpp"

namespace nearpose::simulate {
namespace {

constexpr double kNear_m = 0.3, kFar_m = 0.75;

// Its edges are between the columns 119 and 120, 209 and 210, and the rows 69 and 70, 169 and 170; `more` pixels
// farther outside.
Card card(double more = 0.0) {
    const auto x = [](double u) { return kNear_m * (u - kCamera.cx) / kCamera.fx; };
    const auto y = [](double v) { return kNear_m * (v - kCamera.cy) / kCamera.fy; };
    return {kNear_m, x(119.5 - more), x(209.5 + more), y(69.5 - more), y(169.5 + more)};
}

RenderedImage rendered(const std::vector<Card>& all) {
    return cards(all)(Pose{}, kCamera);
}

DepthImage exact() {
    return rendered({card()}).depth;
}

// The image with all of it `pixels` farther right.
DepthImage moved_right(const DepthImage& image, int pixels) {
    DepthImage moved = image;
    for (int v = 0; v < image.height; ++v)
        for (int u = image.width - 1; u >= pixels; --u)
            moved.depth_m[static_cast<std::size_t>(v * image.width + u)] =
                image.depth_m[static_cast<std::size_t>(v * image.width + u - pixels)];
    return moved;
}

EdgeGrowth growth_of(const DepthImage& measured, const DepthImage& truth = exact()) {
    EdgeMeter meter;
    meter.add(measured, truth);
    return meter.growth();
}

TEST(EdgeGrowth, OfExactDepthIsNone) {
    const EdgeGrowth growth = growth_of(rendered({{kFar_m}, card()}).depth);
    for (const EdgeSide& side : growth.sides) {
        EXPECT_GT(side.edges, 60);
        EXPECT_EQ(side.growth_pixels.value, 0.0);
        EXPECT_EQ(side.scatter_pixels.value, 0.0);
    }
    EXPECT_TRUE(growth.along_rows.fitted && growth.along_columns.fitted);
}

TEST(EdgeGrowth, IsByHowManyPixelsTheObjectIsTooLarge) {
    for (const int more : {-3, 2, 6}) {
        const EdgeGrowth growth = growth_of(rendered({{kFar_m}, card(more)}).depth);
        for (const EdgeSide& side : growth.sides) EXPECT_NEAR(side.growth_pixels.value, more, 1e-9);
        EXPECT_NEAR(growth.along_rows.value, more, 1e-9);
        EXPECT_NEAR(growth.along_columns.value, more, 1e-9);
    }
}

TEST(EdgeGrowth, AShiftedPoseCancelsBetweenOppositeSides) {
    const EdgeGrowth growth = growth_of(rendered({{kFar_m}, card(1.0)}).depth, moved_right(exact(), 3));
    EXPECT_NEAR(growth.sides[0].growth_pixels.value, 1.0 + 3.0, 1e-9);
    EXPECT_NEAR(growth.sides[1].growth_pixels.value, 1.0 - 3.0, 1e-9);
    EXPECT_NEAR(growth.along_rows.value, 1.0, 1e-9);
}

TEST(EdgeGrowth, SaysWhatItCouldNotMeasure) {
    const auto told = [](const EdgeGrowth& growth, const std::string& part) {
        for (const std::string& note : growth.notes)
            if (note.find(part) != std::string::npos) return true;
        return false;
    };
    // A shadow of twenty pixels on the left.
    DepthImage shaded = rendered({{kFar_m}, card()}).depth;
    for (int v = 0; v < kCamera.height; ++v)
        for (int u = 100; u < 120; ++u) shaded.depth_m[static_cast<std::size_t>(v * kCamera.width + u)] = 0.0F;
    const EdgeGrowth shadow = growth_of(shaded);
    EXPECT_EQ(shadow.sides[0].edges, 0);
    EXPECT_GT(shadow.sides[0].without_depth, 60);
    EXPECT_FALSE(shadow.along_rows.fitted);
    EXPECT_TRUE(shadow.along_columns.fitted);
    EXPECT_TRUE(told(shadow, "left side could not be determined: most or all of the edge has no depth"));
    EXPECT_TRUE(told(shadow, "along rows: growth there cannot be told from a shifted pose"));
    // Light in a few rows of it does not tell of the whole side.
    for (int v = 100; v < 120; ++v)
        for (int u = 100; u < 120; ++u) shaded.depth_m[static_cast<std::size_t>(v * kCamera.width + u)] = kFar_m;
    EXPECT_GT(growth_of(shaded).sides[0].edges, 10);
    EXPECT_FALSE(growth_of(shaded).sides[0].growth_pixels.fitted);
    // Nothing farther behind it.
    const EdgeGrowth flat = growth_of(rendered({{kNear_m * 1.02}, card()}).depth);
    for (const EdgeSide& side : flat.sides) EXPECT_EQ(side.edges, 0);
    EXPECT_TRUE(told(flat, "upper side could not be determined: no straight edge"));
    // Something else is before it.
    const EdgeGrowth hidden = growth_of(rendered({{kFar_m}, card(), {0.2}}).depth);
    for (const EdgeSide& side : hidden.sides) EXPECT_EQ(side.edges, 0);
    EXPECT_THROW(growth_of(DepthImage{2, 2, std::vector<float>(4)}), std::invalid_argument);
}

// Noise, jitter, flying pixels and drop-outs go to both sides of an edge alike.
TEST(EdgeGrowth, OfSimpleNoiseIsNone) {
    SensorNoise noise;
    noise.baseline_m = 0.0;  // no shadow
    const DepthSensor sensor(noise, kCamera, 1);
    EdgeMeter meter;
    for (int frame = 0; frame < 10; ++frame)
        meter.add(sensor.measure(rendered({{kFar_m}, card()}), static_cast<std::uint64_t>(frame)), exact());
    const EdgeGrowth growth = meter.growth();
    for (const EdgeSide& side : growth.sides) {
        EXPECT_NEAR(side.growth_pixels.value, 0.0, 0.15);
        EXPECT_LT(side.scatter_pixels.value, 1.0);
    }
    EXPECT_NEAR(growth.along_rows.value, 0.0, 0.1);
    EXPECT_NEAR(growth.along_columns.value, 0.0, 0.1);
}

// As NearObjectsGrowByUpToHalfAWindow (stereo_sensor_test.cpp), now measured as of a recording.
TEST(EdgeGrowth, OfAMatcherGrowsWithItsWindow) {
    if (!stereo_is_built()) GTEST_SKIP() << "built without OpenCV: no stereo matching";
    const auto growth_with = [](int window) {
        StereoRig rig = test_rig();
        rig.window_pixels = window;
        EdgeMeter meter;
        for (std::uint64_t seed = 1; seed <= 4; ++seed) meter.add(measured({{kFar_m}, card()}, rig, seed), exact());
        return meter.growth();
    };
    const EdgeGrowth five = growth_with(5), nine = growth_with(9);
    const FittedFigure &narrow = five.sides[1].growth_pixels, &wide = nine.sides[1].growth_pixels;
    EXPECT_EQ(nine.sides[0].edges, 0);  // the shadow
    EXPECT_GT(wide.value, narrow.value + 0.4);
    EXPECT_GT(wide.low, narrow.value);
    EXPECT_LT(wide.value, 4.5);
    EXPECT_GT(nine.along_columns.value, five.along_columns.value);
}

// Places are what is independent: 95 % of 40 intervals is 38, with a deviation of 1.4.
TEST(EdgeGrowth, IntervalsHoldTheTruthAsOftenAsTheySay) {
    SensorNoise noise;
    noise.baseline_m = 0.0;
    int held = 0;
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        const DepthSensor sensor(noise, kCamera, seed);
        for (const EdgeSide& side : growth_of(sensor.measure(rendered({{kFar_m}, card()}), 0)).sides)
            held += side.growth_pixels.low <= 0.0 && side.growth_pixels.high >= 0.0;
    }
    EXPECT_GE(held, 33);
}

}  // namespace
}  // namespace nearpose::simulate
