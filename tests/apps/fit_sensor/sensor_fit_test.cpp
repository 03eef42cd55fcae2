#include "apps/fit_sensor/sensor_fit.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace nearpose::simulate {
namespace {

const PinholeCamera kCamera{160, 120, 150.0, 150.0, 79.5, 59.5};

struct WallPose {
    double depth_m = 0.5;  // on the optical axis
    double tilt_rad = 0.0;
};

// The wall whose normal is turned by the tilt about y; in a box of pixels a flat thing stands before it.
RenderedImage wall(const WallPose& pose, const PixelBox& box = {}, double box_height_m = 0.0,
                   const PinholeCamera& camera = kCamera) {
    const std::size_t count = static_cast<std::size_t>(camera.width) * camera.height;
    RenderedImage image{{camera.width, camera.height, std::vector<float>(count, 0.0F)},
                        std::vector<int>(count, -1),
                        std::vector<Eigen::Vector3f>(count, Eigen::Vector3f::Zero())};
    const Eigen::Vector3d normal(std::sin(pose.tilt_rad), 0.0, -std::cos(pose.tilt_rad));
    for (int v = 0; v < camera.height; ++v) {
        for (int u = 0; u < camera.width; ++u) {
            double depth_m = -std::cos(pose.tilt_rad) * pose.depth_m / normal.dot(camera.ray(u, v));
            if (!(depth_m > 0.0)) continue;
            if (u >= box.first_u && u < box.last_u && v >= box.first_v && v < box.last_v) depth_m -= box_height_m;
            const std::size_t pixel = static_cast<std::size_t>(v) * camera.width + u;
            image.depth.depth_m[pixel] = static_cast<float>(depth_m);
            image.object[pixel] = 0;
            image.normals_in_camera[pixel] = normal.cast<float>();
        }
    }
    return image;
}

// Axial noise alone.
SensorNoise axial(double floor_m, double per_square_metre, double angle_factor) {
    SensorNoise noise = scaled({}, 0.0);
    noise.sigma_floor_m = floor_m;
    noise.sigma_per_square_metre = per_square_metre;
    noise.angle_factor = angle_factor;
    noise.correlation_pixels = 0.0;
    noise.grazing_begin_rad = 1.4;
    noise.edge_jump_m = 1.0;
    noise.min_range_m = 0.01;
    noise.max_range_m = 10.0;
    return noise;
}

std::vector<WallFrame> record(const SensorNoise& noise, const std::vector<WallPose>& poses, int frames_each,
                              std::uint64_t seed = 1, const PinholeCamera& camera = kCamera) {
    const DepthSensor sensor(noise, camera, seed);
    std::vector<WallFrame> frames;
    for (const WallPose& pose : poses) {
        const RenderedImage exact = wall(pose, {}, 0.0, camera);
        for (int i = 0; i < frames_each; ++i) {
            const int id = static_cast<int>(frames.size());
            frames.push_back({id, camera, sensor.measure(exact, static_cast<std::uint64_t>(id))});
        }
    }
    return frames;
}

const std::vector<WallPose> kManyPoses{{0.3, 0.0}, {0.6, 0.0}, {1.2, 0.0}, {0.5, 0.7}, {0.5, 1.0}};

// The truth lies within the interval, made wider to the 99.8 % that a fixed seed deserves.
void expect_within(const FittedFigure& figure, double truth) {
    EXPECT_TRUE(figure.fitted);
    EXPECT_LE(figure.low, figure.value);
    EXPECT_LE(figure.value, figure.high);
    EXPECT_LT(std::abs(figure.value - truth), 3.1 / 1.96 * 0.5 * (figure.high - figure.low))
        << figure.value << " for " << truth << ", " << figure.low << " to " << figure.high;
}

std::string refusal(const std::vector<WallFrame>& frames, const SensorFitOptions& options = {}) {
    try {
        fit_sensor(frames, axial(0.0005, 0.0015, 0.0), 0.0, options);
    } catch (const std::runtime_error& error) {
        return error.what();
    }
    return {};
}

TEST(WallPlane, IsExactForAnExactWall) {
    const WallPose pose{0.7, 0.6};
    const WallSensor sensor{axial(0.001, 0.0, 0.0), 0.0};
    const WallFrame frame{0, kCamera, wall(pose).depth};
    const auto fit = fit_wall_plane(frame, region_of(kCamera, {}), sensor, 100);
    ASSERT_TRUE(fit.has_value());
    // normal . X = -cos(tilt) * depth
    const Eigen::Vector3d expected = Eigen::Vector3d(std::sin(pose.tilt_rad), 0.0, -std::cos(pose.tilt_rad)) /
                                     (-std::cos(pose.tilt_rad) * pose.depth_m);
    EXPECT_LT((fit->plane.inverse_m - expected).norm(), 1e-5);
    EXPECT_NEAR(fit->plane.angle_rad(kCamera.ray(kCamera.cx, kCamera.cy)), pose.tilt_rad, 1e-5);
    EXPECT_EQ(fit->pixels, kCamera.width * kCamera.height);
    EXPECT_FALSE(fit_wall_plane(frame, region_of(kCamera, {}), sensor, fit->pixels + 1).has_value());
}

TEST(WallPlane, DoesNotFollowAThingBeforeIt) {
    const WallSensor sensor{axial(0.001, 0.0, 0.0), 0.0};
    const DepthSensor camera(sensor.noise, kCamera, 3);
    const PixelBox box{0, 0, 60, 80};  // a quarter
    const WallFrame frame{0, kCamera, camera.measure(wall({0.7, 0.3}, box, 0.15), 0)};
    const auto fit = fit_wall_plane(frame, region_of(kCamera, {}), sensor, 100);
    ASSERT_TRUE(fit.has_value());
    EXPECT_NEAR(fit->outlier_share, 0.25, 0.001);
    EXPECT_NEAR(fit->plane.depth_m(kCamera.ray(kCamera.cx, kCamera.cy)), 0.7, 1e-4);
    EXPECT_LT(fit->structured_share, 0.05);
}

TEST(SensorFit, RecoversFloorDepthAndAngle) {
    const SensorNoise truth = axial(0.0005, 0.002, 0.1);
    const SensorFit fit = fit_sensor(record(truth, kManyPoses, 4), axial(0.001, 0.001, 0.0), 0.0);
    EXPECT_TRUE(fit.separated);
    EXPECT_EQ(fit.frames, 20);
    ASSERT_EQ(fit.groups.size(), kManyPoses.size());
    EXPECT_NEAR(fit.noise.sigma_floor_m, truth.sigma_floor_m, 0.05 * truth.sigma_floor_m);
    EXPECT_NEAR(fit.noise.sigma_per_square_metre, truth.sigma_per_square_metre, 0.05 * truth.sigma_per_square_metre);
    EXPECT_NEAR(fit.noise.angle_factor, truth.angle_factor, 0.05 * truth.angle_factor);
    expect_within(fit.sigma_floor_m, truth.sigma_floor_m);
    expect_within(fit.sigma_per_square_metre, truth.sigma_per_square_metre);
    expect_within(fit.angle_factor, truth.angle_factor);
    EXPECT_LT(fit.sigma_floor_m.high - fit.sigma_floor_m.low, 0.1 * truth.sigma_floor_m);
    EXPECT_EQ(fit.correlation_pixels.low, 0.0);
    EXPECT_LT(fit.correlation_pixels.high, 0.35);
    EXPECT_LT(fit.misfit, 1.5);
    EXPECT_TRUE(fit.notes.empty()) << fit.notes.front();
    EXPECT_NEAR(fit.groups[1].sigma_m, truth.sigma_m(0.6), 0.03 * truth.sigma_m(0.6));
    EXPECT_NEAR(fit.groups[1].fitted_sigma_m, fit.groups[1].sigma_m, 0.03 * truth.sigma_m(0.6));
}

TEST(SensorFit, OffsetOfTheBaseIsUsed) {
    SensorNoise truth = axial(0.0012, 0.0019, 0.0);
    truth.sigma_least_at_m = 0.4;
    SensorNoise base = axial(0.001, 0.001, 0.0);
    base.sigma_least_at_m = 0.4;
    const SensorFit fit = fit_sensor(record(truth, {{0.4, 0.0}, {1.0, 0.0}, {2.0, 0.0}}, 3), base, 0.0);
    expect_within(fit.sigma_floor_m, truth.sigma_floor_m);
    expect_within(fit.sigma_per_square_metre, truth.sigma_per_square_metre);
}

// The intervals are neither too narrow nor too wide: 95 % of 24 is 22.8, with a deviation of 1.1.
TEST(SensorFit, IntervalsHoldTheTruthAsOftenAsTheySay) {
    const PinholeCamera small{80, 60, 75.0, 75.0, 39.5, 29.5};
    SensorNoise truth = axial(0.0005, 0.002, 0.0);
    truth.correlation_pixels = 0.8;
    int floor_held = 0, growth_held = 0;
    for (std::uint64_t seed = 1; seed <= 24; ++seed) {
        const auto frames = record(truth, {{0.3, 0.0}, {0.6, 0.0}, {0.9, 0.0}}, 2, seed, small);
        const SensorFit fit = fit_sensor(frames, axial(0.0004, 0.003, 0.0), 0.0);
        const auto holds = [](const FittedFigure& figure, double value) {
            return figure.low <= value && value <= figure.high;
        };
        floor_held += holds(fit.sigma_floor_m, truth.sigma_floor_m);
        growth_held += holds(fit.sigma_per_square_metre, truth.sigma_per_square_metre);
        EXPECT_NEAR(fit.correlation_pixels.value, 0.8, 0.08);
        EXPECT_LT(fit.sigma_floor_m.high - fit.sigma_floor_m.low, 0.3 * truth.sigma_floor_m);
    }
    EXPECT_GE(floor_held, 20);
    EXPECT_GE(growth_held, 20);
}

TEST(SensorFit, FixedErrorIsNotTakenForNoise) {
    SensorNoise truth = axial(0.0005, 0.0, 0.0);
    truth.bias_sigma_m = 0.001;
    truth.bias_length_pixels = 8.0;
    SensorNoise base = axial(0.0005, 0.0005, 0.0);
    base.bias_length_pixels = 8.0;
    const std::vector<WallPose> poses{{0.4, 0.0}, {0.8, 0.0}};
    const SensorFit several = fit_sensor(record(truth, poses, 5), base, 0.0);
    EXPECT_NEAR(several.noise.bias_sigma_m, 0.001, 0.00015);
    expect_within(several.bias_sigma_m, 0.001);
    EXPECT_NEAR(several.groups[0].sigma_m, 0.0005, 0.03 * 0.0005);
    EXPECT_NEAR(several.groups[1].sigma_m, 0.0005, 0.03 * 0.0005);

    const SensorFit alone = fit_sensor(record(truth, poses, 1), base, 0.0);
    EXPECT_FALSE(alone.separated);
    EXPECT_EQ(alone.noise.bias_sigma_m, 0.0);
    EXPECT_GT(alone.groups[0].sigma_m, 0.0009);
    ASSERT_FALSE(alone.notes.empty());
    EXPECT_NE(alone.notes.front().find("cannot be told apart"), std::string::npos);
}

// The plane takes a part of a smooth field with it; the figure must not come out low for that. 16 fields of 9 % each.
TEST(SensorFit, SmoothFixedErrorIsNotUnderrated) {
    SensorNoise truth = axial(0.0002, 0.0, 0.0);
    truth.bias_sigma_m = 0.001;
    truth.bias_length_pixels = 16.0;
    double mean_m = 0.0;
    int held = 0;
    for (std::uint64_t seed = 1; seed <= 16; ++seed) {
        const SensorFit fit = fit_sensor(record(truth, {{0.4, 0.0}}, 2, seed), truth, 0.0);
        mean_m += fit.bias_sigma_m.value / 16.0;
        held += fit.bias_sigma_m.low <= 0.001 && 0.001 <= fit.bias_sigma_m.high;
    }
    EXPECT_NEAR(mean_m, 0.001, 0.00005);
    EXPECT_GE(held, 13);
}

TEST(SensorFit, OneDistanceKeepsTheGrowthWithDepth) {
    const SensorNoise truth = axial(0.0005, 0.002, 0.0);
    SensorFitOptions options;
    options.region = PixelBox{50, 30, 110, 90};  // rays of nearly one angle
    const SensorFit fit = fit_sensor(record(truth, {{0.5, 0.0}}, 4), axial(0.001, 0.001, 0.07), 0.0, options);
    EXPECT_FALSE(fit.sigma_per_square_metre.fitted);
    EXPECT_FALSE(fit.angle_factor.fitted);
    EXPECT_EQ(fit.noise.sigma_per_square_metre, 0.001);
    EXPECT_EQ(fit.noise.angle_factor, 0.07);
    EXPECT_EQ(fit.groups[0].pixels, 3600);
    // 0.5 mm + 2 mm/m^2 * 0.25 m^2 = 1 mm, of which the base's growth gives 0.25 mm.
    EXPECT_NEAR(fit.noise.sigma_floor_m, 0.00075, 0.03 * 0.001);
    ASSERT_EQ(fit.notes.size(), 2U);
    EXPECT_NE(fit.notes[0].find("one distance"), std::string::npos);
    EXPECT_NE(fit.notes[1].find("angle_factor"), std::string::npos);
}

TEST(SensorFit, WhatTheBaseExplainsIsNotLaidToAxialNoise) {
    SensorNoise truth = axial(0.0005, 0.002, 0.0);
    truth.jitter_pixels = 0.5;
    truth.baseline_m = 0.05;
    truth.disparity_step_pixels = 0.015625;
    const std::vector<WallPose> poses{{0.4, 0.0}, {0.8, 0.0}, {0.5, 0.6}, {0.8, 0.6}};
    SensorFitOptions options;
    options.region = PixelBox{60, 0, 160, 120};  // beside the second imager's blind band
    const SensorFit fit = fit_sensor(record(truth, poses, 4), truth, 0.0, options);
    EXPECT_NEAR(fit.noise.sigma_floor_m, 0.0005, 0.1 * 0.0005);
    EXPECT_NEAR(fit.noise.sigma_per_square_metre, 0.002, 0.1 * 0.002);
    EXPECT_LT(fit.noise.angle_factor, 0.03);
}

TEST(SensorFit, CorrelationIsMeasuredAlongRowsAndColumns) {
    SensorNoise truth = axial(0.001, 0.0, 0.0);
    truth.correlation_pixels = 1.5;
    const SensorFit both = fit_sensor(record(truth, {{0.4, 0.0}, {0.8, 0.0}}, 3), truth, 0.0);
    EXPECT_NEAR(both.row_correlation_pixels.value, 1.5, 0.3 * 1.5);
    EXPECT_NEAR(both.column_correlation_pixels.value, 1.5, 0.3 * 1.5);
    expect_within(both.row_correlation_pixels, 1.5);
    expect_within(both.column_correlation_pixels, 1.5);
    std::vector<WallFrame> frames = record(axial(0.001, 0.0, 0.0), {{0.4, 0.0}, {0.8, 0.0}}, 3);
    for (WallFrame& frame : frames)  // each pixel shares half of its noise with the next in the row
        for (std::size_t i = 0; i + 1 < frame.depth.depth_m.size(); ++i)
            frame.depth.depth_m[i] = 0.5F * (frame.depth.depth_m[i] + frame.depth.depth_m[i + 1]);
    const SensorFit rows = fit_sensor(frames, truth, 0.0);
    EXPECT_GT(rows.row_correlation_pixels.low, 0.3);
    EXPECT_LT(rows.column_correlation_pixels.high, 0.35);
}

TEST(SensorFit, RefusesWhatIsNoFlatWall) {
    const SensorNoise noise = axial(0.0005, 0.0015, 0.0);
    const DepthSensor sensor(noise, kCamera, 4);
    const auto frame_of = [&](const PixelBox& box, double height_m) {
        return std::vector<WallFrame>{{17, kCamera, sensor.measure(wall({0.5, 0.2}, box, height_m), 0)}};
    };
    for (const PixelBox& box : {PixelBox{80, 0, 160, 120}, PixelBox{30, 20, 120, 90}}) {  // a step, a box
        const std::string said = refusal(frame_of(box, 0.06));
        EXPECT_NE(said.find("do not show a flat wall: frame 17"), std::string::npos) << said;
        EXPECT_NE(said.find("--region"), std::string::npos) << said;
        SensorFitOptions options;
        options.region = PixelBox{0, 0, 30, 120};
        EXPECT_EQ(refusal(frame_of(box, 0.06), options), "");
    }
    // A small thing is left out, and so is a sensor much noisier than the base no reason to refuse.
    EXPECT_EQ(refusal(frame_of({0, 0, 40, 30}, 0.06)), "");
    EXPECT_EQ(refusal(record(axial(0.008, 0.0, 0.0), {{0.5, 0.2}}, 2)), "");
    // A bowl: smooth, and without outliers.
    std::vector<WallFrame> bowl = frame_of({}, 0.0);
    for (int i = 0; i < kCamera.width * kCamera.height; ++i) {
        const double u = i % kCamera.width - kCamera.cx;
        bowl[0].depth.depth_m[static_cast<std::size_t>(i)] += static_cast<float>(1e-5 * u * u);
    }
    EXPECT_NE(refusal(bowl).find("flat wall"), std::string::npos);
}

TEST(SensorFit, RefusesTooLittle) {
    EXPECT_NE(refusal({}).find("no frames"), std::string::npos);
    auto frames = record(axial(0.0005, 0.0015, 0.0), {{0.5, 0.0}}, 2);
    SensorFitOptions options;
    options.region = PixelBox{0, 0, 20, 20};
    EXPECT_NE(refusal(frames, options).find("fewer than 500 pixels with depth in the region of 400"),
              std::string::npos);
    frames[1].camera.width = frames[1].depth.width = 150;
    EXPECT_THROW(fit_sensor(frames, axial(0.0005, 0.0015, 0.0), 0.0), std::invalid_argument);
}

TEST(SensorFit, LeavesOutFramesThatAreAlone) {
    const SensorNoise noise = axial(0.0005, 0.0015, 0.0);
    auto frames = record(noise, {{0.4, 0.0}, {0.8, 0.0}}, 3);
    frames.push_back(record(noise, {{1.6, 0.0}}, 1).front());
    const SensorFit fit = fit_sensor(frames, noise, 0.0);
    EXPECT_EQ(fit.frames, 6);
    EXPECT_EQ(fit.groups.size(), 2U);
    ASSERT_FALSE(fit.notes.empty());
    EXPECT_NE(fit.notes.front().find("1 frames are alone"), std::string::npos);
}

}  // namespace
}  // namespace nearpose::simulate
