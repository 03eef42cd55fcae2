// Faults of a sensor that are off by default: noise by angle, highlights, errors by frame, errors of scale.
#include <gtest/gtest.h>

#include <cmath>

#include "apps/depth_sensor/sensor_noise.hpp"

namespace nearpose::simulate {
namespace {

const PinholeCamera kCamera{160, 120, 150.0, 150.0, 79.5, 59.5};
constexpr std::size_t kCount = 160 * 120;

RenderedImage wall(float depth_m) {
    return {{kCamera.width, kCamera.height, std::vector<float>(kCount, depth_m)},
            std::vector<int>(kCount, 0),
            std::vector<Eigen::Vector3f>(kCount, -Eigen::Vector3f::UnitZ())};
}

// Each pixel's normal turned by the same angle from its own ray.
RenderedImage wall_at_angle(float depth_m, double angle_rad) {
    RenderedImage image = wall(depth_m);
    for (int pixel = 0; pixel < static_cast<int>(kCount); ++pixel) {
        const Eigen::Vector3d ray = kCamera.ray(pixel % kCamera.width, pixel / kCamera.width).normalized();
        const Eigen::Vector3d side = ray.cross(Eigen::Vector3d::UnitY()).normalized();
        image.normals_in_camera[static_cast<std::size_t>(pixel)] =
            (-std::cos(angle_rad) * ray + std::sin(angle_rad) * side).cast<float>();
    }
    return image;
}

SensorNoise faultless() {
    SensorNoise noise = scaled({}, 0.0);
    noise.correlation_pixels = 0.0;
    noise.min_range_m = 0.01;
    return noise;
}

struct Spread {
    double mean = 0.0, deviation = 0.0;
};

Spread spread_of(const DepthImage& measured, double depth_m) {
    Spread spread;
    for (const float depth : measured.depth_m) {
        EXPECT_GT(depth, 0.0F);
        spread.mean += (depth - depth_m) / kCount;
        spread.deviation += (depth - depth_m) * (depth - depth_m) / kCount;
    }
    spread.deviation = std::sqrt(spread.deviation);
    return spread;
}

TEST(SensorFaults, AxialNoiseGrowsWithTheAngle) {
    SensorNoise noise = faultless();
    noise.sigma_floor_m = 0.0004;
    noise.sigma_per_square_metre = 0.002;
    noise.sigma_least_at_m = 0.4;
    noise.angle_factor = 0.07;
    for (const double angle : {0.0, 0.6, 1.0, 1.3, 1.4}) {
        const double t = angle / (M_PI / 2 - angle);
        const double sigma = (0.0004 + 0.002 * 0.6 * 0.6) * (1.0 + 0.07 * t * t);
        const Spread spread = spread_of(DepthSensor(noise, kCamera, 5).measure(wall_at_angle(1.0F, angle), 2), 1.0);
        EXPECT_NEAR(spread.deviation / sigma, 1.0, 0.025) << angle;  // 5 standard errors of 19200 pixels
        EXPECT_NEAR(spread.mean / sigma, 0.0, 0.036) << angle;
    }
}

TEST(SensorFaults, HighlightsLieWhereTheMirrorDirectionSays) {
    SensorNoise noise = faultless();
    noise.specular_drop_probability = 1.0;
    noise.specular_angle_rad = 0.3;
    // A light in the camera's place: the ray comes back mirrored at twice its angle from the wall's normal.
    const DepthImage measured = DepthSensor(noise, kCamera, 1).measure(wall(0.5F), 0);
    int dropped = 0;
    for (int pixel = 0; pixel < static_cast<int>(kCount); ++pixel) {
        const Eigen::Vector3d ray = kCamera.ray(pixel % kCamera.width, pixel / kCamera.width);
        const double angle = std::atan2(ray.head<2>().norm(), 1.0);
        if (std::abs(2.0 * angle - 0.3) < 1e-6) continue;
        const bool no_depth = measured.depth_m[static_cast<std::size_t>(pixel)] == 0.0F;
        ASSERT_EQ(no_depth, 2.0 * angle < 0.3) << pixel;
        dropped += no_depth ? 1 : 0;
    }
    EXPECT_GT(dropped, 1000);

    noise.specular_drop_probability = 0.5;
    int sometimes = 0;
    for (std::uint64_t frame = 0; frame < 20; ++frame) {
        const DepthImage patchy = DepthSensor(noise, kCamera, 1).measure(wall(0.5F), frame);
        for (std::size_t i = 0; i < kCount; ++i) {
            if (patchy.depth_m[i] != 0.0F) continue;
            ASSERT_EQ(measured.depth_m[i], 0.0F);
            ++sometimes;
        }
    }
    EXPECT_NEAR(sometimes / 20.0 / dropped, 0.5, 0.06);
}

TEST(SensorFaults, HighlightOfALightBesideTheCameraLiesHalfWayToIt) {
    SensorNoise noise = faultless();
    noise.specular_drop_probability = 1.0;
    noise.light_offset_m = 0.1;
    const DepthImage measured = DepthSensor(noise, kCamera, 1).measure(wall(0.5F), 0);
    double sum_u = 0.0, sum_v = 0.0;
    int dropped = 0;
    for (int pixel = 0; pixel < static_cast<int>(kCount); ++pixel) {
        if (measured.depth_m[static_cast<std::size_t>(pixel)] != 0.0F) continue;
        sum_u += pixel % kCamera.width;
        sum_v += pixel / kCamera.width;
        ++dropped;
    }
    ASSERT_GT(dropped, 50);
    EXPECT_NEAR(sum_u / dropped, kCamera.cx + kCamera.fx * 0.05 / 0.5, 0.5);
    EXPECT_NEAR(sum_v / dropped, kCamera.cy, 0.5);
}

TEST(SensorFaults, FrameBiasIsSmoothAndAnotherOneInEveryFrame) {
    SensorNoise noise = faultless();
    noise.frame_bias_sigma_m = 0.001;
    noise.frame_bias_length_pixels = 10.0;
    const DepthSensor sensor(noise, kCamera, 3);
    const DepthImage first = sensor.measure(wall(0.5F), 0), second = sensor.measure(wall(0.5F), 1);
    EXPECT_EQ(first.depth_m, sensor.measure(wall(0.5F), 0).depth_m);
    EXPECT_NEAR(spread_of(first, 0.5).deviation / 0.001, 1.0, 0.2);
    double product = 0.0, step = 0.0;
    for (std::size_t i = 1; i < kCount; ++i) {
        product += (first.depth_m[i] - 0.5) * (second.depth_m[i] - 0.5) / 1e-6 / kCount;
        if (i % 160 != 0) step = std::max(step, std::abs(1.0 * first.depth_m[i] - first.depth_m[i - 1]));
    }
    EXPECT_NEAR(product, 0.0, 0.25);  // about 200 independent nodes
    EXPECT_LT(step, 0.6e-3);
}

TEST(SensorFaults, ScaleErrorIsExact) {
    for (const double error : {0.25, -0.25, 0.0}) {
        SensorNoise noise = faultless();
        noise.depth_scale_error = error;
        for (const float depth : DepthSensor(noise, kCamera, 1).measure(wall(0.5F), 0).depth_m) {
            ASSERT_EQ(depth, static_cast<float>(0.5 * (1.0 + error)));
        }
    }
}

TEST(SensorFaults, ScaleWithTheNoise) {
    SensorNoise noise;
    noise.angle_factor = 0.1;
    noise.frame_bias_sigma_m = 0.001;
    noise.depth_scale_error = -0.004;
    noise.specular_drop_probability = 0.6;
    const SensorNoise twice = scaled(noise, 2.0);
    EXPECT_EQ(twice.angle_factor, 0.1);  // times a sigma that is twice as large
    EXPECT_EQ(twice.frame_bias_sigma_m, 0.002);
    EXPECT_EQ(twice.depth_scale_error, -0.008);
    EXPECT_EQ(twice.specular_drop_probability, 1.0);
    const SensorNoise none = scaled(noise, 0.0);
    EXPECT_EQ(none.specular_drop_probability + none.frame_bias_sigma_m + std::abs(none.depth_scale_error), 0.0);
}

}  // namespace
}  // namespace nearpose::simulate
