#include "core/base/random.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace nearpose {
namespace {

TEST(Random, TheAddressDecidesAndNothingElse) {
    RandomStream a(1, 2, 3, RandomPurpose::kStart), b(1, 2, 3, RandomPurpose::kStart);
    for (int k = 0; k < 10; ++k) EXPECT_EQ(a.bits(), b.bits());
}

TEST(Random, EveryPartOfTheAddressMatters) {
    std::set<std::uint64_t> first;
    for (std::uint64_t seed = 0; seed < 5; ++seed)
        for (std::uint64_t step = 0; step < 5; ++step)
            for (std::uint64_t particle = 0; particle < 5; ++particle)
                for (const auto purpose : {RandomPurpose::kStart, RandomPurpose::kDiffusion})
                    first.insert(RandomStream(seed, step, particle, purpose).bits());
    EXPECT_EQ(first.size(), 250U);
}

TEST(Random, MomentsOfUniformAndGaussian) {
    RandomStream random(7, 0, 0, RandomPurpose::kDiffusion);
    constexpr int kDraws = 100000;
    double u1 = 0, u2 = 0, g1 = 0, g2 = 0, g4 = 0;
    for (int k = 0; k < kDraws; ++k) {
        const double u = random.uniform(), g = random.gaussian();
        ASSERT_TRUE(u >= 0.0 && u < 1.0);
        u1 += u, u2 += u * u, g1 += g, g2 += g * g, g4 += g * g * g * g;
    }
    EXPECT_NEAR(u1 / kDraws, 0.5, 0.005);
    EXPECT_NEAR(u2 / kDraws, 1.0 / 3.0, 0.005);
    EXPECT_NEAR(g1 / kDraws, 0.0, 0.015);
    EXPECT_NEAR(g2 / kDraws, 1.0, 0.02);
    EXPECT_NEAR(g4 / kDraws, 3.0, 0.15);
}

TEST(Random, StreamsOfNeighbouringParticlesAreIndependent) {
    double product = 0.0;
    constexpr int kStreams = 50000;
    for (int k = 0; k < kStreams; ++k) {
        RandomStream a(1, 1, k, RandomPurpose::kDiffusion), b(1, 1, k + 1, RandomPurpose::kDiffusion);
        product += a.gaussian() * b.gaussian();
    }
    EXPECT_NEAR(product / kStreams, 0.0, 0.02);
}

TEST(Random, RotationsAreUniform) {
    // The mean of R R' over SO(3) is one third of the identity for each column's outer product, and E[angle] is
    // pi/2 + 2/pi (Haar measure).
    Eigen::Matrix3d outer = Eigen::Matrix3d::Zero();
    double angle = 0.0;
    constexpr int kDraws = 50000;
    RandomStream random(11, 0, 0, RandomPurpose::kStart);
    for (int k = 0; k < kDraws; ++k) {
        const Eigen::Quaterniond q = random.rotation();
        ASSERT_NEAR(q.norm(), 1.0, 1e-12);
        const Eigen::Vector3d x = q * Eigen::Vector3d::UnitX();
        outer += x * x.transpose();
        angle += Eigen::AngleAxisd(q).angle() > M_PI ? 2 * M_PI - Eigen::AngleAxisd(q).angle()
                                                     : Eigen::AngleAxisd(q).angle();
    }
    EXPECT_LT((outer / kDraws - Eigen::Matrix3d::Identity() / 3.0).norm(), 0.01);
    EXPECT_NEAR(angle / kDraws, M_PI / 2 + 2 / M_PI, 0.01);
}

TEST(Random, BelowStaysInRangeAndReachesAll) {
    RandomStream random(3, 0, 0, RandomPurpose::kAlternatives);
    std::set<int> seen;
    for (int k = 0; k < 1000; ++k) seen.insert(random.below(7));
    EXPECT_EQ(seen, (std::set<int>{0, 1, 2, 3, 4, 5, 6}));
}

}  // namespace
}  // namespace nearpose
