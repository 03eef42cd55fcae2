#include "core/observation/observation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/base/random.hpp"
#include "core/observation/observed_grid.hpp"
#include "tests/core/analytic_part.hpp"

namespace nearpose {
namespace {

const PinholeCamera kCamera = test::small_camera();

// A plane a x + b y + z = d in camera coordinates, so its unit normal towards the camera is -(a, b, 1) / |.|.
DepthImage plane(double a, double b, double d) {
    DepthImage image{kCamera.width, kCamera.height, {}};
    for (int v = 0; v < kCamera.height; ++v)
        for (int u = 0; u < kCamera.width; ++u) {
            const Eigen::Vector3d ray = kCamera.ray(u, v);
            image.depth_m.push_back(static_cast<float>(d / (a * ray.x() + b * ray.y() + 1.0)));
        }
    return image;
}

TEST(Observation, NormalsOfAPlaneAreExactAndTowardsTheCamera) {
    const Observation observation = make_observation(plane(0.3, -0.2, 0.5), kCamera, {});
    const Eigen::Vector3d expected = -Eigen::Vector3d(0.3, -0.2, 1.0).normalized();
    int known = 0;
    for (std::size_t p = 0; p < observation.points_in_camera().size(); ++p) {
        const Eigen::Vector3f normal = observation.normals_in_camera()[p];
        if (normal.isZero()) continue;  // at the image's edge
        ++known;
        EXPECT_LT((normal.cast<double>() - expected).norm(), 1e-4);
    }
    EXPECT_GT(known, 0.8 * static_cast<double>(observation.points_in_camera().size()));
}

TEST(Observation, DepthEdgesHaveNoNormal) {
    DepthImage image = plane(0, 0, 0.5);
    for (int v = 0; v < kCamera.height; ++v)
        for (int u = 80; u < kCamera.width; ++u) image.depth_m[v * kCamera.width + u] = 0.9F;
    const Observation observation = make_observation(image, kCamera, {});
    EXPECT_TRUE(observation.normal_at(60 * kCamera.width + 79, 2).isZero());
    EXPECT_FALSE(observation.normal_at(60 * kCamera.width + 70, 2).isZero());
}

TEST(Observation, PixelsWithoutDepthAreNoBackground) {
    DepthImage image = plane(0, 0, 0.5);
    image.depth_m[0] = 0.0F;
    image.depth_m[1] = std::nanf("");
    image.depth_m[2] = -1.0F;
    image.depth_m[3] = std::numeric_limits<float>::infinity();
    image.depth_m[4] = 0.001F;  // nearer than the sensor can measure
    Mask mask{kCamera.width, kCamera.height, std::vector<std::uint8_t>(image.depth_m.size(), 0)};
    mask.value[0] = mask.value[6] = 1;
    const Observation observation = make_observation(image, kCamera, mask);
    for (int pixel = 0; pixel < 5; ++pixel) EXPECT_EQ(observation.states()[pixel], PixelState::kNoDepth) << pixel;
    EXPECT_EQ(observation.states()[5], PixelState::kBackground);
    EXPECT_EQ(observation.states()[6], PixelState::kCandidate);
    EXPECT_EQ(observation.num_candidates(), 1);
}

TEST(Observation, BoxHoldsTheCandidatesExactly) {
    const DepthImage image = plane(0, 0, 0.5);
    Mask mask{kCamera.width, kCamera.height, std::vector<std::uint8_t>(image.depth_m.size(), 0)};
    for (int v = 10; v < 30; ++v)
        for (int u = 40; u < 90; ++u) mask.value[v * kCamera.width + u] = 1;
    const Observation observation = make_observation(image, kCamera, mask);
    const PixelBox& box = observation.candidate_box();
    EXPECT_EQ(box.first_u, 40);
    EXPECT_EQ(box.last_u, 90);
    EXPECT_EQ(box.first_v, 10);
    EXPECT_EQ(box.last_v, 30);
    EXPECT_EQ(observation.num_candidates(), 1000);
}

TEST(Observation, TheCloudIsBoundedAndItsCentroidRight) {
    ObservationOptions options;
    options.max_points = 500;
    const Observation observation = make_observation(plane(0, 0, 0.5), kCamera, {}, options);
    EXPECT_LE(observation.points_in_camera().size(), 500U);
    EXPECT_GT(observation.points_in_camera().size(), 250U);
    EXPECT_NEAR(observation.centroid_in_camera().z(), 0.5, 1e-6);
    EXPECT_LT(observation.centroid_in_camera().head<2>().norm(), 0.01);
}

TEST(Observation, EmptyDepthIsAnObservationOfNothing) {
    const DepthImage image{kCamera.width, kCamera.height, std::vector<float>(160 * 120, 0.0F)};
    const Observation observation = make_observation(image, kCamera, {});
    EXPECT_EQ(observation.num_candidates(), 0);
    EXPECT_TRUE(observation.candidate_box().empty());
    EXPECT_TRUE(observation.points_in_camera().empty());
    EXPECT_EQ(observation.mean_distance_m(), 0.0);
}

TEST(Observation, SizesThatDifferAreRefused) {
    DepthImage image = plane(0, 0, 0.5);
    EXPECT_THROW(make_observation(image, kCamera, Mask{80, 60, std::vector<std::uint8_t>(4800, 1)}),
                 std::invalid_argument);
    image.depth_m.pop_back();
    EXPECT_THROW(make_observation(image, kCamera, {}), std::invalid_argument);
    PinholeCamera camera = kCamera;
    camera.width = 161;
    EXPECT_THROW(make_observation(plane(0, 0, 0.5), camera, {}), std::invalid_argument);
}

TEST(Observation, ASparseCloudIsProjectedAtTheResolutionThatItFills) {
    // Every fifth pixel of a plane: at full resolution its image would be mostly holes.
    const DepthImage image = plane(0.1, 0, 0.5);
    std::vector<Eigen::Vector3f> cloud;
    for (int v = 20; v < 100; v += 5)
        for (int u = 30; u < 130; u += 5)
            cloud.push_back((image.depth_m[v * kCamera.width + u] * kCamera.ray(u, v)).cast<float>());
    cloud.emplace_back(std::nanf(""), 0.0F, 0.5F);
    cloud.emplace_back(0.0F, 0.0F, -0.5F);  // behind the camera
    const Observation observation = make_observation(cloud, kCamera);
    EXPECT_TRUE(observation.segmented());
    EXPECT_GE(kCamera.width / observation.camera().width, 4);
    const PixelBox& box = observation.candidate_box();
    const int area = (box.last_u - box.first_u) * (box.last_v - box.first_v);
    EXPECT_GT(observation.num_candidates(), 0.75 * area);
    // A pixel's point lies within half a coarse pixel of the plane's own.
    for (const Eigen::Vector3f& point : observation.points_in_camera())
        EXPECT_NEAR(0.1F * point.x() + point.z(), 0.5F, 0.002F);
}

TEST(Observation, GridHoldsTheImagesOwnValues) {
    const Observation observation = make_observation(plane(0.3, -0.2, 0.5), kCamera, {});
    const ObservedGrid observed = observe(observation, grid_over({10, 10, 110, 90}, 300));
    for (int index = 0; index < observed.grid.size(); ++index) {
        const int pixel = observed.grid.image_v(index) * kCamera.width + observed.grid.image_u(index);
        EXPECT_EQ(observed.depth_m[index], observation.depth_m()[pixel]);
        EXPECT_EQ(observed.states[index], observation.states()[pixel]);
    }
    EXPECT_EQ(observed.num_candidates, observed.grid.size());
}

TEST(Observation, MeasuresHowNoisyTheImageIs) {
    // A tilted plane with white noise of a known multiple of the sensor model's.
    const PinholeCamera camera{160, 120, 150.0, 150.0, 79.5, 59.5};
    const SensorModel sensor;
    for (const double factor : {1.0, 2.0, 4.0}) {
        RandomStream random(5, 0, 0, RandomPurpose::kDiffusion);
        DepthImage image{160, 120, {}};
        for (int pixel = 0; pixel < 160 * 120; ++pixel) {
            const Eigen::Vector3d ray = camera.ray(pixel % 160, pixel / 160);
            const double depth_m = 0.5 / (1.0 + 0.4 * ray.x() - 0.2 * ray.y());
            image.depth_m.push_back(static_cast<float>(depth_m + factor * sensor.sigma_m(depth_m) * random.gaussian()));
        }
        EXPECT_NEAR(make_observation(image, camera, {}).noise_factor() / factor, 1.0, 0.06) << factor;
    }
}

}  // namespace
}  // namespace nearpose
