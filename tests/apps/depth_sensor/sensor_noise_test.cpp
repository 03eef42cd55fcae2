#include "apps/depth_sensor/sensor_noise.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "apps/base/simulation_draws.hpp"
#include "apps/depth_sensor/noise_field.hpp"

namespace nearpose::simulate {
namespace {

const PinholeCamera kCamera{160, 120, 150.0, 150.0, 79.5, 59.5};

RenderedImage empty_image() {
    const std::size_t count = static_cast<std::size_t>(kCamera.width) * kCamera.height;
    return {{kCamera.width, kCamera.height, std::vector<float>(count, 0.0F)},
            std::vector<int>(count, -1),
            std::vector<Eigen::Vector3f>(count, Eigen::Vector3f::Zero())};
}

// The plane through (0, 0, z0_m) whose normal is turned by `tilt_rad` about y, in the pixels' columns first_u..last_u.
void add_plane(RenderedImage& image, double z0_m, double tilt_rad, int first_u, int last_u) {
    const Eigen::Vector3d normal(std::sin(tilt_rad), 0.0, -std::cos(tilt_rad));
    for (int v = 0; v < kCamera.height; ++v) {
        for (int u = first_u; u <= last_u; ++u) {
            const double depth = -std::cos(tilt_rad) * z0_m / normal.dot(kCamera.ray(u, v));
            if (depth <= 0.0) continue;
            const std::size_t pixel = static_cast<std::size_t>(v) * kCamera.width + u;
            image.depth.depth_m[pixel] = static_cast<float>(depth);
            image.object[pixel] = 0;
            image.normals_in_camera[pixel] = normal.cast<float>();
        }
    }
}

RenderedImage plane(double z0_m, double tilt_rad = 0.0) {
    RenderedImage image = empty_image();
    add_plane(image, z0_m, tilt_rad, 0, kCamera.width - 1);
    return image;
}

// Without any fault; tests add the one that they are about.
SensorNoise ideal() {
    SensorNoise noise = scaled({}, 0.0);
    noise.min_range_m = 0.01;
    return noise;
}

double deviation(const std::vector<double>& values) {
    double sum = 0.0;
    for (const double value : values) sum += value * value;
    return std::sqrt(sum / static_cast<double>(values.size()));
}

// 1.4826 times the median of absolute values: the standard deviation of a Gaussian around 0.
double robust_spread(std::vector<double> values) {
    for (double& value : values) value = std::abs(value);
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
    return 1.4826 * values[values.size() / 2];
}

std::vector<double> residuals(const DepthImage& measured, const RenderedImage& exact) {
    std::vector<double> result;
    for (std::size_t i = 0; i < measured.depth_m.size(); ++i) {
        if (measured.depth_m[i] > 0.0F) result.push_back(measured.depth_m[i] - exact.depth.depth_m[i]);
    }
    return result;
}

double dropped_fraction(const DepthImage& measured) {
    return static_cast<double>(std::count(measured.depth_m.begin(), measured.depth_m.end(), 0.0F)) /
           static_cast<double>(measured.depth_m.size());
}

TEST(CorrelatedNoise, HasUnitVarianceAlsoAtTheBorder) {
    std::vector<double> inside, corner, neighbours, far;
    for (std::uint64_t frame = 0; frame < 2000; ++frame) {
        const auto noise = correlated_noise(12, 10, 0.8, 5, frame, kPixelDraw);
        inside.push_back(noise[5 * 12 + 6][0]);
        corner.push_back(noise[0][3]);
        neighbours.push_back((noise[5 * 12 + 6] * noise[5 * 12 + 7])[1]);
        far.push_back((noise[2] * noise[9 * 12 + 11])[1]);
    }
    const auto mean = [](const std::vector<double>& v) {
        double sum = 0.0;
        for (const double x : v) sum += x;
        return sum / static_cast<double>(v.size());
    };
    EXPECT_NEAR(deviation(inside), 1.0, 0.06);
    EXPECT_NEAR(deviation(corner), 1.0, 0.06);
    EXPECT_NEAR(mean(neighbours), std::exp(-1.0 / (4.0 * 0.8 * 0.8)), 0.08);  // two Gaussians' overlap, one pixel apart
    EXPECT_NEAR(mean(far), 0.0, 0.08);
}

TEST(SmoothField, HasUnitVarianceAndIsSmooth) {
    std::vector<double> at_node, between, steps;
    for (std::uint64_t seed = 0; seed < 2000; ++seed) {
        const std::vector<float> field = smooth_field(30, 20, 8.0, seed, 0, kBiasDraw);
        at_node.push_back(field[8 * 30 + 8]);
        between.push_back(field[12 * 30 + 12]);
        steps.push_back(field[12 * 30 + 12] - field[12 * 30 + 13]);
    }
    EXPECT_NEAR(deviation(at_node), 1.0, 0.06);
    EXPECT_NEAR(deviation(between), 1.0, 0.06);
    EXPECT_LT(deviation(steps), 0.2);
}

TEST(DepthSensor, WithoutFaultsGivesTheExactDepth) {
    const RenderedImage exact = plane(0.5, 0.7);
    const DepthImage measured = DepthSensor(ideal(), kCamera, 1).measure(exact, 0);
    for (std::size_t i = 0; i < measured.depth_m.size(); ++i) {
        ASSERT_NEAR(measured.depth_m[i], exact.depth.depth_m[i], 1e-6 * exact.depth.depth_m[i]);
    }
}

TEST(DepthSensor, AxialNoiseHasTheSizeAskedForAtEveryDistance) {
    for (const double depth_m : {0.2, 1.0, 2.0}) {
        SensorNoise noise = ideal();
        noise.sigma_floor_m = 0.0005;
        noise.sigma_per_square_metre = 0.0015;
        const RenderedImage exact = plane(depth_m);
        const auto spread = [&](double scale) {
            return robust_spread(residuals(DepthSensor(scaled(noise, scale), kCamera, 3).measure(exact, 9), exact));
        };
        EXPECT_NEAR(spread(1.0) / noise.sigma_m(depth_m), 1.0, 0.05);
        EXPECT_NEAR(spread(3.0) / spread(1.0), 3.0, 0.01);
    }
}

TEST(DepthSensor, BiasIsFixedOverTheSequence) {
    SensorNoise noise = ideal();
    noise.bias_sigma_m = 0.0005;
    noise.bias_length_pixels = 8.0;
    const RenderedImage exact = plane(0.3);
    const DepthSensor sensor(noise, kCamera, 3);
    const DepthImage first = sensor.measure(exact, 0);
    EXPECT_EQ(first.depth_m, sensor.measure(exact, 7).depth_m);
    EXPECT_NE(first.depth_m, DepthSensor(noise, kCamera, 4).measure(exact, 0).depth_m);
    EXPECT_NEAR(deviation(residuals(first, exact)) / noise.bias_sigma_m, 1.0, 0.2);
}

TEST(DepthSensor, JitterActsThroughTheSlope) {
    SensorNoise noise = ideal();
    noise.jitter_pixels = 0.5;
    EXPECT_LT(deviation(residuals(DepthSensor(noise, kCamera, 1).measure(plane(0.4), 0), plane(0.4))), 1e-6);
    const double tilt = 0.6;
    const RenderedImage exact = plane(0.4, tilt);
    const DepthImage measured = DepthSensor(noise, kCamera, 1).measure(exact, 0);
    std::vector<double> relative;
    for (int v = 0; v < kCamera.height; ++v) {
        for (int u = 0; u < kCamera.width; ++u) {
            const std::size_t i = static_cast<std::size_t>(v) * kCamera.width + u;
            // z = z0 / (1 - tan(tilt) x), so dz/du = z^2 / z0 * tan(tilt) / fx.
            const double z = exact.depth.depth_m[i];
            relative.push_back((measured.depth_m[i] - z) / (z * z / 0.4 * std::tan(tilt) / kCamera.fx));
        }
    }
    EXPECT_NEAR(robust_spread(relative), 0.5, 0.03);
}

TEST(DepthSensor, DepthComesInStepsOfDisparity) {
    SensorNoise noise = ideal();
    noise.baseline_m = 0.018;
    noise.disparity_step_pixels = 0.125;
    noise.sigma_floor_m = 0.002;
    const DepthImage measured = DepthSensor(noise, kCamera, 1).measure(plane(0.4), 0);
    std::set<long> steps;
    for (const float depth : measured.depth_m) {
        if (depth == 0.0F) continue;
        const double step = kCamera.fx * noise.baseline_m / depth / noise.disparity_step_pixels;
        ASSERT_NEAR(step, std::round(step), 1e-4);
        steps.insert(std::lround(step));
    }
    EXPECT_GT(steps.size(), 1u);
}

TEST(DepthSensor, GrazingSurfacesDropOut) {
    SensorNoise noise = ideal();
    noise.grazing_drop_probability = 1.0;
    noise.grazing_begin_rad = 1.0;
    noise.grazing_end_rad = 1.2;
    RenderedImage exact = plane(0.4);
    const auto dropped_at = [&](double angle_rad) {
        // Only the normals matter here: each is turned from its own ray.
        for (int pixel = 0; pixel < kCamera.width * kCamera.height; ++pixel) {
            const Eigen::Vector3d ray = kCamera.ray(pixel % kCamera.width, pixel / kCamera.width).normalized();
            const Eigen::Vector3d side = ray.cross(Eigen::Vector3d::UnitY()).normalized();
            exact.normals_in_camera[static_cast<std::size_t>(pixel)] =
                (-std::cos(angle_rad) * ray + std::sin(angle_rad) * side).cast<float>();
        }
        return dropped_fraction(DepthSensor(noise, kCamera, 1).measure(exact, 0));
    };
    EXPECT_EQ(dropped_at(0.99), 0.0);
    EXPECT_EQ(dropped_at(1.21), 1.0);
    const double middle = std::acos(0.5 * (std::cos(1.0) + std::cos(1.2)));
    EXPECT_NEAR(dropped_at(middle), 0.5, 0.05);
    noise.grazing_drop_probability = 0.4;
    EXPECT_NEAR(dropped_at(1.3), 0.4, 0.05);
}

TEST(DepthSensor, StereoShadowsLieOnTheLeftOfNearObjects) {
    SensorNoise noise = ideal();
    noise.baseline_m = 0.05;
    RenderedImage exact = plane(0.5);
    add_plane(exact, 0.25, 0.0, 80, 119);
    const DepthImage measured = DepthSensor(noise, kCamera, 1).measure(exact, 0);
    // Disparities: 15 pixels behind, 30 on the object. So 15 columns on its left are hidden, and the first 15 of the
    // image lie outside the second image.
    for (int u = 0; u < kCamera.width; ++u) {
        const float depth = measured.depth_m[static_cast<std::size_t>(60 * kCamera.width + u)];
        EXPECT_EQ(depth == 0.0F, u < 15 || (u >= 65 && u < 80)) << u;
    }
}

TEST(DepthSensor, EdgesDropOutAndFly) {
    SensorNoise noise = ideal();
    noise.edge_drop_probability = 0.4;
    noise.flying_probability = 0.5;
    RenderedImage exact = plane(0.5);
    add_plane(exact, 0.3, 0.0, 80, 159);
    int at_edge = 0, dropped = 0, flying = 0;
    for (std::uint64_t frame = 0; frame < 10; ++frame) {
        const DepthImage measured = DepthSensor(noise, kCamera, 1).measure(exact, frame);
        for (int pixel = 0; pixel < kCamera.width * kCamera.height; ++pixel) {
            const int u = pixel % kCamera.width;
            const float depth = measured.depth_m[static_cast<std::size_t>(pixel)];
            if (u < 78 || u > 81) {
                ASSERT_NEAR(depth, u < 80 ? 0.5 : 0.3, 1e-6);
                continue;
            }
            ++at_edge;
            if (depth == 0.0F) {
                ++dropped;
            } else {
                ASSERT_GT(depth, 0.2999F);
                ASSERT_LT(depth, 0.5001F);
                if (depth > 0.301F && depth < 0.499F) ++flying;
            }
        }
    }
    EXPECT_NEAR(static_cast<double>(dropped) / at_edge, 0.4, 0.03);
    EXPECT_NEAR(static_cast<double>(flying) / at_edge, 0.6 * 0.5, 0.03);
}

TEST(DepthSensor, MeasuresOnlyWithinItsRange) {
    SensorNoise noise = ideal();
    noise.min_range_m = 0.3;
    noise.max_range_m = 0.6;
    EXPECT_EQ(dropped_fraction(DepthSensor(noise, kCamera, 1).measure(plane(0.29), 0)), 1.0);
    EXPECT_EQ(dropped_fraction(DepthSensor(noise, kCamera, 1).measure(plane(0.31), 0)), 0.0);
    EXPECT_EQ(dropped_fraction(DepthSensor(noise, kCamera, 1).measure(plane(0.61), 0)), 1.0);
    EXPECT_EQ(dropped_fraction(DepthSensor(noise, kCamera, 1).measure(empty_image(), 0)), 1.0);
}

TEST(DepthSensor, SeedAndFrameNameTheDraws) {
    const RenderedImage exact = plane(0.4, 0.3);
    const DepthImage image = DepthSensor({}, kCamera, 1).measure(exact, 5);
    EXPECT_EQ(image.depth_m, DepthSensor({}, kCamera, 1).measure(exact, 5).depth_m);
    EXPECT_NE(image.depth_m, DepthSensor({}, kCamera, 1).measure(exact, 6).depth_m);
    EXPECT_NE(image.depth_m, DepthSensor({}, kCamera, 2).measure(exact, 5).depth_m);
}

TEST(SensorNoise, IsCheckedByField) {
    SensorNoise noise;
    EXPECT_NO_THROW(validate(noise));
    EXPECT_NO_THROW(validate(scaled(noise, 0.0)));
    EXPECT_NO_THROW(validate(scaled(noise, 50.0)));
    noise.jitter_pixels = -1.0;
    EXPECT_THROW(validate(noise), std::invalid_argument);
    EXPECT_THROW(scaled({}, -1.0), std::invalid_argument);
}

}  // namespace
}  // namespace nearpose::simulate
