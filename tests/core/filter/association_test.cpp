#include "core/filter/association.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/core/analytic_part.hpp"

namespace nearpose {
namespace {

const test::BoxViewGenerator kPart(test::asymmetric_part());
const PinholeCamera kCamera = test::small_camera();
const Pose kTruth{Eigen::Quaterniond(Eigen::AngleAxisd(2.6, Eigen::Vector3d(1, 0.3, 0.1).normalized())),
                  {0.01, 0, 0.45}};

// Of the distance between the measured point and the pair's plane.
double sigma_of_pair(const Observation& observation, const Correspondences& pairs, std::size_t k) {
    const double depth_m = pairs.points_in_camera[k].z();
    const double normal_z = (kTruth.rotation * pairs.normals_in_object[k].cast<double>()).z();
    return std::sqrt(
        observation.sensor().variance_along_normal_m2(observation.sigma_m(depth_m), depth_m, normal_z, kCamera.fx));
}

Observation observe_part() {
    Mask mask;
    const DepthImage image = test::render(kPart, kTruth, kCamera, 0.8F, &mask);
    return make_observation(image, kCamera, mask);
}

TEST(Correspondence, ProjectiveAtTheTruthPairsEveryPointWithItself) {
    const Observation observation = observe_part();
    const View view = kPart.generate(kTruth, kCamera);
    const Correspondences pairs = associate_projective(view, kTruth, observation, 0.01, 0.0);
    ASSERT_EQ(pairs.size(), view.size());
    for (std::size_t k = 0; k < pairs.size(); ++k) {
        const Eigen::Vector3d model = kTruth * pairs.points_in_object[k].cast<double>();
        EXPECT_LT((model - pairs.points_in_camera[k].cast<double>()).norm(), 1e-6);
        EXPECT_NEAR(pairs.sigmas_m[k], sigma_of_pair(observation, pairs, k), 1e-8);
    }
}

TEST(Correspondence, NearestEqualsBruteForceWithinTheGate) {
    const Observation observation = observe_part();
    const Pose pose = kTruth * exp((Twist() << 0.05, 0, 0.02, 0.01, 0.0, 0.005).finished());
    const View view = kPart.generate(pose, camera_of(grid_over({0, 0, 160, 120}, 800), kCamera));
    constexpr double kGate = 0.006;
    const Correspondences pairs = associate_nearest(view, pose, observation, kGate);
    std::size_t expected = 0;
    for (std::size_t k = 0; k < view.size(); ++k) {
        const Eigen::Vector3f query = (pose * view.points_in_object[k].cast<double>()).cast<float>();
        float best = 1e9F;
        for (const Eigen::Vector3f& point : observation.points_in_camera())
            best = std::min(best, (point - query).norm());
        if (best > kGate) continue;
        ASSERT_LT(expected, pairs.size());
        EXPECT_NEAR((pairs.points_in_camera[expected] - query).norm(), best, 1e-6F);
        ++expected;
    }
    EXPECT_EQ(pairs.size(), expected);
    EXPECT_GT(expected, 20U);
    EXPECT_LT(expected, view.size()) << "the gate must cut some, or it is not tested";
}

TEST(Correspondence, ExtraSigmaAddsInQuadrature) {
    const Observation observation = observe_part();
    const View view = kPart.generate(kTruth, kCamera);
    const Correspondences pairs = associate_projective(view, kTruth, observation, 0.01, 0.004);
    EXPECT_NEAR(pairs.sigmas_m[0], std::hypot(sigma_of_pair(observation, pairs, 0), 0.004), 1e-7);
}

TEST(Correspondence, NormalCheckDropsTheWrongSideOnly) {
    Correspondences pairs;
    for (const double angle : {0.0, 0.3, 0.7, 3.0}) {
        pairs.points_in_object.emplace_back(0, 0, 0);
        pairs.points_in_camera.emplace_back(0, 0, 1);
        pairs.normals_in_object.emplace_back(0, 0, -1);
        pairs.normals_in_camera.emplace_back(std::sin(angle), 0, -std::cos(angle));
        pairs.sigmas_m.push_back(0.001F);
    }
    pairs.normals_in_camera.back().setZero();  // unknown: stays
    const Correspondences kept = reject_by_normal(pairs, Pose::identity(), 0.5);
    ASSERT_EQ(kept.size(), 3U);
    EXPECT_TRUE(kept.normals_in_camera[2].isZero());
}

TEST(Correspondence, SampleConsensusKeepsTheRigidMajority) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> uniform(-0.1F, 0.1F);
    Correspondences pairs;
    for (int k = 0; k < 100; ++k) {
        const Eigen::Vector3f point(uniform(random), uniform(random), uniform(random));
        pairs.points_in_object.push_back(point);
        pairs.normals_in_object.emplace_back(0, 0, 1);
        Eigen::Vector3f measured = (kTruth * point.cast<double>()).cast<float>();
        if (k % 4 == 0) measured += Eigen::Vector3f(0.08F, uniform(random), 0.05F);  // outliers
        pairs.points_in_camera.push_back(measured);
        pairs.sigmas_m.push_back(0.001F);
    }
    const RandomStream stream(1, 1, 1, RandomPurpose::kSampleConsensus);
    const Correspondences kept = reject_by_sample_consensus(pairs, {50, 0.005}, stream);
    EXPECT_EQ(kept.size(), 75U);
    for (std::size_t k = 0; k < kept.size(); ++k)
        EXPECT_LT((kTruth * kept.points_in_object[k].cast<double>() - kept.points_in_camera[k].cast<double>()).norm(),
                  1e-5);
}

TEST(Correspondence, SampleConsensusOfFewOrFlatPairsKeepsThem) {
    Correspondences pairs;
    const RandomStream stream(1, 1, 1, RandomPurpose::kSampleConsensus);
    EXPECT_EQ(reject_by_sample_consensus(pairs, {10, 0.01}, stream).size(), 0U);
    for (int k = 0; k < 10; ++k) {  // on one line: no triple defines a motion
        pairs.points_in_object.emplace_back(0.01F * static_cast<float>(k), 0, 0);
        pairs.normals_in_object.emplace_back(0, 0, 1);
        pairs.points_in_camera.emplace_back(0.01F * static_cast<float>(k), 0, 1);
        pairs.sigmas_m.push_back(0.001F);
    }
    EXPECT_EQ(reject_by_sample_consensus(pairs, {10, 0.01}, stream).size(), 10U);
}

}  // namespace
}  // namespace nearpose
