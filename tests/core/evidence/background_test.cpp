// The null hypothesis: walls explain themselves, and a part is shown by what walls do not explain.
#include "core/evidence/background.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/core/analytic_part.hpp"

namespace nearpose {
namespace {

const test::BoxViewGenerator kPart(test::asymmetric_part());
const PinholeCamera kCamera = test::small_camera();
const Pose kTruth{Eigen::Quaterniond(Eigen::AngleAxisd(2.7, Eigen::Vector3d(1, 0.3, 0.1).normalized())),
                  {0.0, 0, 0.45}};
const PixelGrid kGrid = grid_over({0, 0, 160, 120}, 5000);

struct Seen {
    std::vector<PlaneCoefficients> planes;
    PositiveEvidence evidence;
};

Seen look(const DepthImage& image, const Pose& pose) {
    const ObservedGrid observed = observe(make_observation(image, kCamera, std::nullopt), kGrid);
    const View view = kPart.generate(pose, observed.camera);
    Seen seen;
    seen.planes = fit_background(view, observed, {}, {});
    seen.evidence = positive_evidence(view, pose, observed, seen.planes, {}, {});
    return seen;
}

// The depth of the nearest of some planes normal . X = distance along each pixel's ray, with noise.
DepthImage image_of_planes(const std::vector<std::pair<Eigen::Vector3d, double>>& planes, double noise_m) {
    std::mt19937 engine(1);
    std::normal_distribution<double> noise(0.0, noise_m);
    DepthImage image{kCamera.width, kCamera.height, {}};
    for (int pixel = 0; pixel < kCamera.width * kCamera.height; ++pixel) {
        const Eigen::Vector3d ray = kCamera.ray(pixel % kCamera.width, pixel / kCamera.width);
        double depth_m = 10.0;
        for (const auto& [normal, distance_m] : planes)
            if (normal.dot(ray) > 1e-3) depth_m = std::min(depth_m, distance_m / normal.dot(ray));
        image.depth_m.push_back(static_cast<float>(depth_m + noise(engine)));
    }
    return image;
}

TEST(Background, FindsThePlaneOfAWall) {
    const Eigen::Vector3d normal = Eigen::Vector3d(0.3, -0.2, 1.0).normalized();
    const Seen seen = look(image_of_planes({{normal, 0.4}}, 0.0), kTruth);
    ASSERT_EQ(seen.planes.size(), 1U);
    EXPECT_LT((seen.planes[0].cast<double>() - normal / 0.4).norm(), 1e-4) << "coefficients . X = 1";
}

TEST(Background, NoPoseIsShownByWallsAlone) {
    const std::vector<std::pair<Eigen::Vector3d, double>> wall = {{Eigen::Vector3d(0.1, 0.1, 1).normalized(), 0.40}};
    auto corner = wall;
    corner.push_back({Eigen::Vector3d(1.0, 0.0, 0.7).normalized(), 0.30});
    for (const auto& planes : {wall, corner})
        for (const double noise_m : {0.0, 0.0007}) {
            const DepthImage image = image_of_planes(planes, noise_m);
            for (double depth_m = 0.3; depth_m < 0.6; depth_m += 0.02)
                for (const double angle : {0.0, 0.5, 1.5, 2.7}) {
                    const Pose pose{Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitX())),
                                    {0.0, 0, depth_m}};
                    EXPECT_LE(look(image, pose).evidence.total(), 0.0) << depth_m << " m, turned by " << angle;
                }
        }
}

TEST(Background, APartBeforeAWallIsShownByItsReliefAndSteps) {
    for (const float wall_m : {0.5F, 0.6F, 0.9F}) {
        const PositiveEvidence evidence = look(test::render(kPart, kTruth, kCamera, wall_m, nullptr), kTruth).evidence;
        const double rays = static_cast<double>(kPart.generate(kTruth, camera_of(kGrid, kCamera)).size());
        EXPECT_GT(evidence.total(), 0.3 * rays) << "wall at " << wall_m << " m";
        EXPECT_GT(evidence.relief, 0.0);
        EXPECT_EQ(evidence.free_space, 0.0);
    }
}

TEST(Background, FacesOfThePartAreNoBackground) {
    const DepthImage image = test::render(kPart, kTruth, kCamera, 0.9F, nullptr);
    const Seen seen = look(image, kTruth);
    ASSERT_EQ(seen.planes.size(), 1U) << "the wall alone";
    EXPECT_NEAR(seen.planes[0].z(), 1.0 / 0.9, 1e-3);
}

TEST(Background, APoseThatTheSensorSeesThroughIsShownByNothing) {
    Pose before = kTruth;
    before.translation.z() -= 0.1;
    const PositiveEvidence evidence = look(test::render(kPart, kTruth, kCamera, 0.9F, nullptr), before).evidence;
    EXPECT_GT(evidence.free_space, 0.0);
    EXPECT_LT(evidence.total(), 0.0);
}

TEST(Background, LogOddsCountTheSameAreaAlikeWhateverTheRaysAreApart) {
    SensorModel sensor;  // shares its fine errors over 10 pixels
    PositiveEvidence evidence;
    evidence.relief = 400.0;
    const double fine = log_odds_present(evidence, 1, {}, sensor);
    evidence.relief = 100.0;  // a quarter of the rays, twice as far apart
    EXPECT_DOUBLE_EQ(log_odds_present(evidence, 2, {}, sensor), fine);
    EXPECT_DOUBLE_EQ(log_odds_present(evidence, 20, {}, sensor), 100.0 * 4.5) << "each ray is a piece of evidence";
}

}  // namespace
}  // namespace nearpose
