#include "core/search/hypothesis_pruning.hpp"

#include <gtest/gtest.h>

#include "core/search/pair_hypotheses.hpp"
#include "tests/core/analytic_part.hpp"

namespace nearpose {
namespace {

const test::BoxViewGenerator kPart(test::asymmetric_part());
const PinholeCamera kCamera{320, 240, 300.0, 300.0, 159.5, 119.5};
const Pose kTruth{Eigen::Quaterniond(Eigen::AngleAxisd(2.5, Eigen::Vector3d(1, 0.4, 0.2).normalized())),
                  {0.03, -0.01, 0.55}};

// The model agrees where it is, and one that floats before the wall was looked through.
TEST(GainOnPatches, PositiveAtTheTruthAndNegativeInFreeSpace) {
    const PointPairTable pairs(kPart);
    Mask mask;
    const Observation observation = make_observation(test::render(kPart, kTruth, kCamera, 0.8F, &mask), kCamera, {});
    const SurfelGrid surfels = surfels_of(observation, pairs, 1, 1);
    const PruningScene scene{pairs.surface(),    surfels, kCamera, balanced_sample(surfels, 256), pairs.points(), 0.01,
                             pairs.diameter_m(), 1};
    const std::size_t all = pairs.points().size();
    EXPECT_GT(evidence_gain(scene, kTruth, all, scene.tolerance_m), 0.0);
    Pose beside = kTruth;
    beside.translation.x() -= 1.5 * pairs.diameter_m() * 0.5;
    beside.translation.z() -= 0.1;
    EXPECT_LT(evidence_gain(scene, beside, all, scene.tolerance_m), 0.0);
    Pose behind_camera = kTruth;
    behind_camera.translation.z() = -1.0;
    EXPECT_EQ(evidence_gain(scene, behind_camera, all, scene.tolerance_m), 0.0);
}

}  // namespace
}  // namespace nearpose
