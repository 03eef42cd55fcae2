#include "core/filter/particles.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace nearpose {
namespace {

ParticleSet particles_at_x(const std::vector<double>& weights) {
    ParticleSet particles;
    for (std::size_t i = 0; i < weights.size(); ++i)
        particles.poses.push_back({Eigen::Quaterniond::Identity(), {static_cast<double>(i), 0, 0}});
    particles.negative_log_weights = weights;
    return particles;
}

TEST(Particles, EffectiveSampleSizeOfKnownWeights) {
    EXPECT_NEAR(effective_sample_size({3.0, 3.0, 3.0, 3.0}), 4.0, 1e-12) << "equal weights, wherever they lie";
    EXPECT_NEAR(effective_sample_size({0.0, 1000.0, 1000.0}), 1.0, 1e-12);
    EXPECT_NEAR(effective_sample_size({0.0, std::log(3.0)}), 1.0 / (0.75 * 0.75 + 0.25 * 0.25), 1e-12);
    EXPECT_EQ(effective_sample_size({}), 0.0);
}

TEST(Particles, EffectiveSampleSizeIgnoresTheOffsetAndNeverUnderflows) {
    EXPECT_NEAR(effective_sample_size({1e6, 1e6 + 1.0}), effective_sample_size({0.0, 1.0}), 1e-9);
    EXPECT_NEAR(effective_sample_size({-1e6, -1e6 + 1.0}), effective_sample_size({0.0, 1.0}), 1e-9);
}

TEST(Particles, ImpossibleAndUndefinedWeights) {
    const double inf = std::numeric_limits<double>::infinity(), nan = std::nan("");
    EXPECT_NEAR(effective_sample_size({0.0, inf, nan}), 1.0, 1e-12);
    EXPECT_NEAR(effective_sample_size({inf, inf}), 2.0, 1e-12) << "all impossible: equal";
    EXPECT_EQ(map_index({nan, 2.0, 1.0, 1.0}), 2) << "the first of equals, never a NaN";
    EXPECT_EQ(map_index({nan, nan}), 0);
    EXPECT_EQ(map_index({}), -1);
}

TEST(Particles, WeightUpdateIsTheMeanOfOldAndNew) {
    ParticleSet particles = particles_at_x({2.0, 4.0});
    update_weights(particles, {6.0, 0.0});
    EXPECT_EQ(particles.negative_log_weights, (std::vector<double>{4.0, 2.0}));
    // A constant likelihood is the fixed point: weights stay representable for ever.
    for (int frame = 0; frame < 100; ++frame) update_weights(particles, {7.0, 7.0});
    EXPECT_NEAR(particles.negative_log_weights[0], 7.0, 1e-12);
}

TEST(Particles, SystematicResamplingTakesEachParticleItsShareRoundedUpOrDown) {
    const std::vector<double> p = {0.1, 0.43, 0.0, 0.27, 0.2};
    std::vector<double> weights;
    for (const double value : p)
        weights.push_back(value > 0 ? -std::log(value) : std::numeric_limits<double>::infinity());
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
        const ParticleSet resampled =
            systematic_resample(particles_at_x(weights), static_cast<int>(weights.size()), seed, 1);
        std::vector<int> copies(p.size(), 0);
        for (const Pose& pose : resampled.poses) ++copies[static_cast<int>(pose.translation.x())];
        for (std::size_t i = 0; i < p.size(); ++i) {
            EXPECT_GE(copies[i], std::floor(5 * p[i] - 1e-9));
            EXPECT_LE(copies[i], std::ceil(5 * p[i] + 1e-9));
        }
        for (const double weight : resampled.negative_log_weights) EXPECT_EQ(weight, 0.0);
    }
}

TEST(Particles, SystematicResamplingIsUnbiased) {
    const std::vector<double> p = {0.1, 0.43, 0.27, 0.2};
    std::vector<double> weights, mean(p.size(), 0.0);
    for (const double value : p) weights.push_back(-std::log(value));
    constexpr int kRuns = 20000;
    for (int run = 0; run < kRuns; ++run)
        for (const Pose& pose :
             systematic_resample(particles_at_x(weights), static_cast<int>(weights.size()), run, 3).poses)
            mean[static_cast<int>(pose.translation.x())] += 1.0 / (kRuns * 4.0);
    for (std::size_t i = 0; i < p.size(); ++i) EXPECT_NEAR(mean[i], p[i], 0.004);
}

TEST(Particles, ResamplingOneWinnerNeverTakesAnother) {
    std::vector<double> weights(100, std::numeric_limits<double>::infinity());
    weights[42] = 5.0;
    for (const Pose& pose : systematic_resample(particles_at_x(weights), static_cast<int>(weights.size()), 1, 1).poses)
        EXPECT_EQ(pose.translation.x(), 42.0);
}

TEST(Particles, ControlMovesTheParticlesAsTheCameraMoved) {
    // The camera moves 0.1 m forward: what it sees comes nearer by that.
    ParticleSet particles = particles_at_x({0.0, 0.0});
    particles.poses[1].translation.z() = 1.0;
    const Pose now_from_before{Eigen::Quaterniond::Identity(), {0, 0, -0.1}};
    propagate(particles, now_from_before);
    EXPECT_NEAR(particles.poses[1].translation.z(), 0.9, 1e-15);
}

TEST(Particles, DiffusionHasTheAskedSpreadAboutTheCentre) {
    constexpr int kCount = 20000;
    const Eigen::Vector3d centre(0.5, 0.2, -0.3);  // the model's origin is far from its centre
    const Pose pose{Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitY())), {0.1, 0.0, 0.8}};
    ParticleSet particles;
    particles.poses.assign(kCount, pose);
    particles.negative_log_weights.assign(kCount, 0.0);
    diffuse(particles, {0.02, 0.005}, centre, 1, 1);
    Eigen::Vector3d shift2 = Eigen::Vector3d::Zero(), turn2 = Eigen::Vector3d::Zero();
    for (const Pose& diffused : particles.poses) {
        shift2 += (pose.rotation.conjugate() * (diffused * centre - pose * centre)).cwiseAbs2() / kCount;
        turn2 += log(pose.inverse() * diffused).head<3>().cwiseAbs2() / kCount;
    }
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(std::sqrt(shift2[axis]), 0.005, 0.0002) << "the centre moves by the translation only";
        EXPECT_NEAR(std::sqrt(turn2[axis]), 0.02, 0.0006);
    }
}

TEST(KldSampling, FollowsTheChiSquareQuantile) {
    // 99 % quantile of chi-square with k - 1 degrees of freedom over 2 epsilon, to the approximation's few percent.
    EXPECT_NEAR(kld_sample_size(2, 0.05), 6.635 / 0.1, 0.04 * 66);
    EXPECT_NEAR(kld_sample_size(11, 0.05), 23.21 / 0.1, 0.01 * 232);
    EXPECT_NEAR(kld_sample_size(101, 0.05), 135.8 / 0.1, 0.01 * 1358);
    EXPECT_EQ(kld_sample_size(1, 0.05), 0);  // one cell is described by any number
    EXPECT_NEAR(kld_sample_size(11, 0.1), 0.5 * kld_sample_size(11, 0.05), 1.0);
}

}  // namespace
}  // namespace nearpose
