// What an image tells of its sensor's noise, on planes whose noise is made up.
#include "core/observation/image_noise.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "core/base/random.hpp"
#include "core/observation/observed_grid.hpp"

namespace nearpose {
namespace {

const PinholeCamera kCamera{320, 240, 300.0, 300.0, 159.5, 119.5};

// A tilted plane; the noise of the inverse depth is white noise, averaged over square windows of that side.
std::vector<float> plane_with_noise(int window_pixels, double sigma) {
    RandomStream random(5, 0, 0, RandomPurpose::kDiffusion);
    const int width = kCamera.width, height = kCamera.height;
    std::vector<double> white(static_cast<std::size_t>(width * height));
    for (double& value : white) value = random.gaussian();
    std::vector<float> depth_m;
    const int half = window_pixels / 2;
    for (int v = 0; v < height; ++v) {
        for (int u = 0; u < width; ++u) {
            double sum = 0.0;
            for (int dv = -half; dv <= half; ++dv)
                for (int du = -half; du <= half; ++du)
                    sum +=
                        white[static_cast<std::size_t>((v + dv + height) % height * width + (u + du + width) % width)];
            const Eigen::Vector3d ray = kCamera.ray(u, v);
            const double inverse = (1.0 + 0.4 * ray.x() - 0.2 * ray.y()) / 0.5 + sigma * sum / window_pixels;
            depth_m.push_back(static_cast<float>(1.0 / inverse));
        }
    }
    return depth_m;
}

double shared_noise(std::vector<float> depth_m) {
    return measured_shared_noise(organise(std::move(depth_m), {}, {}), kCamera, {});
}

TEST(SharedNoise, IsNoneWhereEachPixelHasItsOwn) {
    EXPECT_EQ(shared_noise(plane_with_noise(1, 0.004)), 0.0);
    EXPECT_LT(shared_noise(plane_with_noise(3, 0.004)), 0.5) << "direct neighbours share, pixels two apart hardly";
}

TEST(SharedNoise, IsNearlyFullWhereWindowsShare) {
    for (const int window : {7, 9, 15}) EXPECT_GT(shared_noise(plane_with_noise(window, 0.004)), 0.85) << window;
}

TEST(SharedNoise, DoesNotDependOnHowLargeTheNoiseIs) {
    for (const double sigma : {0.0005, 0.01}) {
        EXPECT_EQ(shared_noise(plane_with_noise(1, sigma)), 0.0) << sigma;
        EXPECT_EQ(shared_noise(plane_with_noise(9, sigma)), 1.0) << sigma;
    }
}

TEST(SharedNoise, IsTakenForFullWhereNothingTells) {
    EXPECT_EQ(shared_noise(std::vector<float>(320 * 240, 0.0F)), 1.0) << "no depth";
    EXPECT_EQ(shared_noise(std::vector<float>(320 * 240, 0.5F)), 1.0) << "no noise";
}

// A wall at 0.6 m on whose right half, from u = 160 on, a plate stands at 0.5 m.
TEST(ObservedGrid, PixelsWithinReachOfADepthStepAreMarked) {
    std::vector<float> depth_m;
    for (int pixel = 0; pixel < 320 * 240; ++pixel) depth_m.push_back(pixel % 320 < 160 ? 0.6F : 0.5F);
    const Observation observation = make_observation({320, 240, depth_m}, kCamera, {});
    const ObservedGrid observed = observe(observation, grid_over({100, 50, 220, 150}, 120 * 100));
    ASSERT_EQ(observed.grid.stride, 1);
    const int reach = static_cast<int>(observation.sensor().edge_pixels);
    for (int index = 0; index < observed.grid.size(); ++index) {
        const int u = observed.grid.image_u(index);
        EXPECT_EQ(observed.at_step[index], u >= 160 - reach && u < 160 + reach) << u;
    }
}

}  // namespace
}  // namespace nearpose
