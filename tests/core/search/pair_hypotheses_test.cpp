#include "core/search/pair_hypotheses.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "tests/core/analytic_part.hpp"

namespace nearpose {
namespace {

const test::BoxViewGenerator kPart(test::asymmetric_part());
const PinholeCamera kCamera{320, 240, 300.0, 300.0, 159.5, 119.5};
const Pose kTruth{Eigen::Quaterniond(Eigen::AngleAxisd(2.5, Eigen::Vector3d(1, 0.4, 0.2).normalized())),
                  {0.03, -0.01, 0.55}};

bool near_truth(const Pose& pose) {
    const Eigen::Vector3d centre = kPart.extent().centre_in_object();
    return (pose * centre - kTruth * centre).norm() < 0.1 * kPart.extent().diameter_m() &&
           angle_between(pose.rotation, kTruth.rotation) < 0.35;
}

// The part before a wall that fills the image.
Observation before_a_wall(bool with_mask) {
    Mask mask;
    const DepthImage image = test::render(kPart, kTruth, kCamera, 0.8F, &mask);
    return make_observation(image, kCamera, with_mask ? std::optional(mask) : std::nullopt);
}

std::vector<Pose> hypotheses(const Observation& observation, const PointPairTable& pairs, int threads = 1) {
    const SurfelGrid surfels = surfels_of(observation, pairs, {}, 1, 1);
    return hypotheses_from_pairs(observation, pairs, surfels, {},
                                 {.draws = 20000, .count = 200, .num_threads = threads}, 1, 1);
}

constexpr double kAngleCell_rad = M_PI / 18.0;  // of the table

// Angles between either normal and the line, and between the normals [rad].
std::array<double, 3> angles_of(const OrientedPoint& first, const OrientedPoint& second) {
    const Eigen::Vector3f line = (second.point - first.point).normalized();
    const auto angle = [](float cosine) { return std::acos(std::clamp(static_cast<double>(cosine), -1.0, 1.0)); };
    return {angle(first.normal.dot(line)), angle(second.normal.dot(line)), angle(first.normal.dot(second.normal))};
}

TEST(PointPairTable, PairsMatchWithinOneCellOfDistanceAndAngles) {
    const PointPairTable pairs(kPart);
    const auto& points = pairs.points();
    int tried = 0;
    for (std::size_t i = 0; i < points.size(); i += 97) {
        for (std::size_t j = 50; j < points.size(); j += 311) {
            const double distance = (points[i].point - points[j].point).norm();
            if (distance < pairs.min_distance_m() || distance >= pairs.max_distance_m()) {
                EXPECT_TRUE(pairs.matches(points[i], points[j]).empty()) << "out of the table";
                continue;
            }
            ++tried;
            for (const PointPairTable::Pair& pair : pairs.matches(points[i], points[j])) {
                const double other = (points[pair.first].point - points[pair.second].point).norm();
                EXPECT_NEAR(other, distance, 0.06 * pairs.diameter_m()) << "one cell of distances";
                const auto angles = angles_of(points[i], points[j]);
                const auto others = angles_of(points[pair.first], points[pair.second]);
                for (int k = 0; k < 3; ++k) {
                    const double cell = std::floor(angles[k] / kAngleCell_rad);
                    EXPECT_GT(others[k], cell * kAngleCell_rad - 1e-3) << "one cell of each angle";
                    EXPECT_LT(others[k], (cell + 1.0) * kAngleCell_rad + 1e-3);
                }
            }
        }
    }
    EXPECT_GT(tried, 100);
}

TEST(Surfels, APlaneLargerThanAnyFaceWeighsLittleAndASmallerOneFully) {
    const PointPairTable pairs(kPart);
    EXPECT_NEAR(pairs.largest_face_m2(), 0.20 * 0.14, 0.3 * 0.20 * 0.14);
    const Observation observation = before_a_wall(false);
    const SurfelGrid surfels = surfels_of(observation, pairs, {}, 1, 1);
    Mask mask;
    test::render(kPart, kTruth, kCamera, 0.8F, &mask);
    double on_part = 0.0, on_wall = 0.0;
    int count_part = 0, count_wall = 0;
    for (int pixel = 0; pixel < kCamera.width * kCamera.height; pixel += 7) {
        const Surfel* surfel = surfels.at(kCamera, pixel);
        if (surfel == nullptr) continue;
        (mask.value[pixel] != 0 ? on_part : on_wall) += surfel->evidence_weight;
        (mask.value[pixel] != 0 ? count_part : count_wall) += 1;
    }
    EXPECT_GT(on_part / count_part, 0.9);
    EXPECT_LT(on_wall / count_wall, 0.1);
}

TEST(PairHypotheses, FindThePartWithAndWithoutAMask) {
    const PointPairTable pairs(kPart);
    for (const bool with_mask : {true, false}) {
        const std::vector<Pose> poses = hypotheses(before_a_wall(with_mask), pairs);
        const auto found = std::find_if(poses.begin(), poses.end(), near_truth);
        ASSERT_NE(found, poses.end()) << with_mask;
        EXPECT_LT(found - poses.begin(), 50) << "among the best";
    }
}

TEST(PairHypotheses, AreNoneWhereNothingIsMeasured) {
    const PointPairTable pairs(kPart);
    const DepthImage empty{kCamera.width, kCamera.height,
                           std::vector<float>(static_cast<std::size_t>(kCamera.width) * kCamera.height, 0.0F)};
    EXPECT_TRUE(hypotheses(make_observation(empty, kCamera, {}), pairs).empty());
}

TEST(PairHypotheses, AreTheSameBitsForAnyNumberOfThreads) {
    const PointPairTable pairs(kPart);
    const Observation observation = before_a_wall(true);
    const std::vector<Pose> one = hypotheses(observation, pairs, 1), three = hypotheses(observation, pairs, 3);
    ASSERT_EQ(one.size(), three.size());
    for (std::size_t k = 0; k < one.size(); ++k) {
        EXPECT_EQ(one[k].translation, three[k].translation);
        EXPECT_EQ(one[k].rotation.coeffs(), three[k].rotation.coeffs());
    }
}

}  // namespace
}  // namespace nearpose
