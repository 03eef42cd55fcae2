#include "core/filter/gradient_step.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/core/analytic_part.hpp"

namespace nearpose {
namespace {

const test::BoxViewGenerator kPart(test::asymmetric_part());
const test::GaussNewtonSolver kSolver;
const PinholeCamera kCamera = test::small_camera();
const Pose kTruth{Eigen::Quaterniond(Eigen::AngleAxisd(2.6, Eigen::Vector3d(1, 0.3, 0.1).normalized())),
                  {0.01, 0, 0.45}};
const RandomStream kRandom(1, 1, 1, RandomPurpose::kSampleConsensus);

class GradientStepTest : public testing::Test {
  protected:
    GradientStepTest()
        : observation_(observe_part()), observed_(observe(observation_, grid_over({0, 0, 160, 120}, 3000))) {}

    static Observation observe_part() {
        Mask mask;
        const DepthImage image = test::render(kPart, kTruth, kCamera, 0.8F, &mask);
        return make_observation(image, kCamera, mask);
    }
    StepContext context(const GradientStep& step, Cost cost = Cost::kPixels) const {
        return {kPart, kSolver, observation_, observed_, step, cost, {}};
    }
    static Pose off(double angle_rad, double shift_m) {
        Twist twist;
        twist << angle_rad, -angle_rad, angle_rad, shift_m, shift_m, -shift_m;
        return kTruth * exp(twist);
    }
    static double distance_m(const Pose& a, const Pose& b) { return (a.translation - b.translation).norm(); }

    Observation observation_;
    ObservedGrid observed_;
};

TEST_F(GradientStepTest, PullsThePoseOntoTheObservation) {
    const Pose start = off(0.03, 0.003);
    const MovedParticle moved = move_particle(start, context({}), kRandom);
    EXPECT_LT(distance_m(moved.camera_from_object, kTruth), 0.2 * distance_m(start, kTruth));
    GradientStep still;
    still.rounds = 0;
    EXPECT_LT(moved.cost, move_particle(start, context(still), kRandom).cost);
}

TEST_F(GradientStepTest, StepSizeIsTheFractionOfTheWayAlongTheGeodesic) {
    GradientStep step;
    step.rounds = 1;
    const Pose start = off(0.03, 0.003);
    const Pose whole = move_particle(start, context(step), kRandom).camera_from_object;
    for (const double gamma : {0.0, 0.25, 0.5}) {
        step.step_size = gamma;
        const Pose part = move_particle(start, context(step), kRandom).camera_from_object;
        EXPECT_LT(log(interpolate(start, whole, gamma).inverse() * part).norm(), 1e-12) << gamma;
    }
}

TEST_F(GradientStepTest, TheCostIsThatOfThePoseThatIsKept) {
    const MovedParticle moved = move_particle(off(0.03, 0.003), context({}), kRandom);
    const View view = kPart.generate(moved.camera_from_object, observed_.camera);
    EXPECT_EQ(moved.cost, pixel_cost(view, moved.camera_from_object, observed_, {}).cost);
}

TEST_F(GradientStepTest, RefiningReachesTheBottom) {
    const RefinedMode refined = refine_mode(off(0.01, 0.001), context({}), {});
    EXPECT_LT(distance_m(refined.camera_from_object, kTruth), 1e-4);
    EXPECT_GT(refined.support, 0.98);
    EXPECT_LT(refined.cost, 0.02);
}

TEST_F(GradientStepTest, CountsAddUp) {
    GradientStep step;
    step.association = Association::kNearest;
    step.max_normal_angle_rad = 0.5;
    step.consensus_draws = 10;
    const MovedParticle moved = move_particle(off(0.03, 0.003), context(step, Cost::kOverlapMse), kRandom);
    EXPECT_EQ(moved.counts.solves, step.rounds);
    EXPECT_EQ(moved.counts.view_points, static_cast<long>(kPart.generate(off(0.03, 0.003), observed_.camera).size()));
    EXPECT_LE(moved.counts.pairs, step.rounds * moved.counts.view_points);
    EXPECT_GT(moved.counts.rejected_by_normal, 0);
    EXPECT_LT(moved.counts.rejected_by_normal + moved.counts.rejected_by_consensus, moved.counts.pairs);
}

// m / n is the ratio of the view's points to the pairs that are left.
TEST_F(GradientStepTest, TheOverlapScalesTheMeanSquaredError) {
    GradientStep step;
    step.association = Association::kNearest;
    step.rounds = 1;
    step.consensus_draws = 10;
    const StepContext scaled = context(step, Cost::kOverlapMse);
    StepContext plain = context(step, Cost::kOverlapMse);
    plain.scale_by_overlap = false;
    const Pose start = off(0.05, 0.01);
    const MovedParticle with = move_particle(start, scaled, kRandom), without = move_particle(start, plain, kRandom);
    const long left = with.counts.pairs - with.counts.rejected_by_consensus;
    ASSERT_LT(left, with.counts.view_points);
    EXPECT_EQ(distance_m(with.camera_from_object, without.camera_from_object), 0.0);
    const double ratio = static_cast<double>(with.counts.view_points) / static_cast<double>(left);
    EXPECT_NEAR(with.cost / without.cost, ratio, 1e-9 * ratio);
}

TEST_F(GradientStepTest, WithoutRoundsThePoseStaysAndIsWeighed) {
    GradientStep still;
    still.rounds = 0;
    still.association = Association::kNearest;
    const Pose near = off(0.02, 0.002), far = off(0.06, 0.02);
    for (const Cost cost : {Cost::kPixels, Cost::kOverlapMse}) {
        const MovedParticle at_near = move_particle(near, context(still, cost), kRandom);
        EXPECT_EQ(log(near.inverse() * at_near.camera_from_object).norm(), 0.0);
        EXPECT_EQ(at_near.counts.solves, 0);
        EXPECT_LT(at_near.cost, move_particle(far, context(still, cost), kRandom).cost);
    }
}

TEST_F(GradientStepTest, ObjectOutOfViewIsTooFewPairsAndKeepsThePose) {
    Pose away = kTruth;
    away.translation.x() += 5.0;
    for (const Cost cost : {Cost::kPixels, Cost::kOverlapMse}) {
        const MovedParticle moved = move_particle(away, context({}, cost), kRandom);
        EXPECT_EQ(moved.counts.solves_with_too_few_pairs, 3);
        EXPECT_EQ(distance_m(moved.camera_from_object, away), 0.0);
        EXPECT_TRUE(std::isfinite(moved.negative_log_likelihood));
    }
}

}  // namespace
}  // namespace nearpose
