#include "core/base/point_index.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace nearpose {
namespace {

std::vector<Eigen::Vector3f> random_points(int count, unsigned seed, float offset) {
    std::mt19937 random(seed);
    std::vector<Eigen::Vector3f> points;
    for (int k = 0; k < count; ++k) {
        const auto draw = [&] { return static_cast<float>(random()) / static_cast<float>(std::mt19937::max()); };
        const float x = draw(), y = draw(), z = draw();
        points.emplace_back(x + offset, y, z);
    }
    return points;
}

float brute_force_squared_distance(const std::vector<Eigen::Vector3f>& points, const Eigen::Vector3f& query) {
    float best = std::numeric_limits<float>::infinity();
    for (const Eigen::Vector3f& point : points) best = std::min(best, (point - query).squaredNorm());
    return best;
}

TEST(PointIndex, EqualsBruteForce) {
    for (const int count : {1, 2, 13, 500, 3000}) {
        const auto points = random_points(count, 1, 0.0F), queries = random_points(300, 2, 0.1F);
        const auto found = PointIndex(points).nearest(queries);
        ASSERT_EQ(found.size(), queries.size());
        for (std::size_t q = 0; q < queries.size(); ++q) {
            ASSERT_GE(found[q].index, 0);
            const float expected = brute_force_squared_distance(points, queries[q]);
            EXPECT_NEAR(found[q].squared_distance_m2, expected, 1e-6F);
            EXPECT_NEAR((points[found[q].index] - queries[q]).squaredNorm(), expected, 1e-6F);
        }
    }
}

TEST(PointIndex, FindsTheSameWithinALimitAndNothingBeyondIt) {
    const PointIndex index(random_points(500, 5, 0.0F));
    const std::vector<Eigen::Vector3f> queries = random_points(400, 6, 0.0F);
    constexpr float kLimit_m = 0.06F;
    const auto all = index.nearest(queries), near = index.nearest(queries, kLimit_m);
    int beyond = 0;
    for (std::size_t q = 0; q < queries.size(); ++q) {
        const bool within = all[q].squared_distance_m2 < kLimit_m * kLimit_m;
        beyond += within ? 0 : 1;
        EXPECT_EQ(near[q].index, within ? all[q].index : -1);
    }
    EXPECT_GT(beyond, 50);
    EXPECT_LT(beyond, 350);
}

TEST(PointIndex, FarFromTheOriginNoDigitsAreLostBeyondTheFloatsOwn) {
    const auto points = random_points(500, 1, 1000.0F);
    const auto found = PointIndex(points).nearest(points);
    for (std::size_t q = 0; q < points.size(); ++q) EXPECT_EQ(found[q].squared_distance_m2, 0.0F);
}

TEST(PointIndex, EmptyCloudFindsNothing) {
    const PointIndex index({});
    EXPECT_EQ(index.nearest({{1, 2, 3}})[0].index, -1);
    EXPECT_TRUE(index.nearest({}).empty());
}

TEST(PointIndex, RefusesPointsThatAreNotFinite) {
    const float nan = std::nanf(""), inf = std::numeric_limits<float>::infinity();
    EXPECT_THROW(PointIndex({{0, 0, 0}, {nan, 0, 0}}), std::invalid_argument);
    EXPECT_THROW(PointIndex({{inf, 0, 0}}), std::invalid_argument);
}

TEST(PointIndex, QueriesThatAreNotFiniteFindNothingAndDoNotDisturbTheOthers) {
    const auto points = random_points(100, 1, 0.0F);
    const float nan = std::nanf("");
    const auto found = PointIndex(points).nearest({points[7], {nan, 0, 0}, points[9]});
    EXPECT_EQ(found[0].index, 7);
    EXPECT_EQ(found[1].index, -1);
    EXPECT_EQ(found[2].index, 9);
}

TEST(PointIndex, EqualPointsAreNoTrouble) {
    const std::vector<Eigen::Vector3f> points(1000, Eigen::Vector3f(1, 2, 3));
    EXPECT_EQ(PointIndex(points).nearest({{1, 2, 3}})[0].squared_distance_m2, 0.0F);
}

}  // namespace
}  // namespace nearpose
