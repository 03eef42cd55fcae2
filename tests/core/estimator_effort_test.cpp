// How much work the estimator spends on a frame.
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "core/estimator.hpp"
#include "tests/core/estimator_scene.hpp"

namespace nearpose {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)

TEST(Estimator, WhileTrackingFewParticlesDoAndAfterALossAllAreBack) {
    PoseEstimator estimator(kPart, kSolver, small_options(method_default(), 0));
    int fewest = 1000;
    for (int frame = 0; frame < 10; ++frame) {
        const UpdateResult result =
            estimator.update(observe_at(frame), frame > 0 ? std::optional(motion_to(frame)) : std::nullopt);
        EXPECT_LT(error_m(result, frame), 0.001) << frame;
        if (frame < 5) {
            EXPECT_EQ(result.effort.particles, 40) << frame;
        }
        EXPECT_GE(result.effort.particles, method_default().effort.min_particles);
        EXPECT_EQ(result.effort.starts > 0, frame == 0) << frame;
        EXPECT_FALSE(result.effort.reduced_for_budget);
        fewest = std::min(fewest, result.effort.particles);
    }
    EXPECT_LT(fewest, 40);
    estimator.update(observe_nothing(), {});
    const UpdateResult after = estimator.update(observe_at(0), {});
    EXPECT_EQ(after.effort.particles, 40);
    EXPECT_GT(after.effort.starts, 0);
    EXPECT_LT(error_m(after, 0), 0.001);
}

TEST(Estimator, AVerifiedEstimateIsConfirmedWithFewerRaysButAllParticlesAndAlternatives) {
    EstimatorOptions options = small_options(method_default(), 0);
    PoseEstimator sparing(kPart, kSolver, options);
    options.method.effort.on = false;
    PoseEstimator whole(kPart, kSolver, options);
    for (int frame = 0; frame < 5; ++frame) {
        const std::optional<Pose> motion = frame > 0 ? std::optional(motion_to(frame)) : std::nullopt;
        const UpdateResult less = sparing.update(observe_at(frame), motion);
        const UpdateResult all = whole.update(observe_at(frame), motion);
        EXPECT_EQ(less.effort.particles, 40) << frame;
        EXPECT_EQ(less.effort.alternatives, options.method.hypotheses.alternatives) << frame;
        EXPECT_LT(error_m(less, frame), 0.001) << frame;
        if (frame == 0) {
            EXPECT_EQ(less.counts.view_points, all.counts.view_points);
        } else {
            EXPECT_LT(less.counts.view_points, 0.6 * static_cast<double>(all.counts.view_points)) << frame;
        }
    }
}

TEST(Estimator, APredictionThatTheImageAgreesWithIsFittedAtOnceAndOnlyThen) {
    // Once the track is confirmed: one solve a particle, none for the mode, unless the prediction and the image
    // disagree.
    PoseEstimator estimator(kPart, kSolver, small_options(method_default(), 0));
    UpdateResult result;
    for (int frame = 0; frame < 8; ++frame)
        result = estimator.update(observe_at(frame), frame > 0 ? std::optional(motion_to(frame)) : std::nullopt);
    EXPECT_EQ(result.counts.solves, result.effort.particles);
    EXPECT_LT(error_m(result, 7), 0.001);
    // Two centimetres of motion that was not measured.
    result = estimator.update(observe_at(8), Pose::identity());
    EXPECT_GT(result.counts.solves, result.effort.particles);
    EXPECT_LT(error_m(result, 8), 0.001);
    // And no motion was measured at all.
    result = estimator.update(observe_at(9), {});
    EXPECT_GE(result.counts.solves, method_default().step.rounds * result.effort.particles);
    EXPECT_LT(error_m(result, 9), 0.001);
}

TEST(Estimator, AFixedNumberOfParticlesStays) {
    EstimatorOptions options = small_options(method_default(), 0);
    options.method.effort.min_particles = options.num_particles;
    PoseEstimator estimator(kPart, kSolver, options);
    for (int frame = 0; frame < 8; ++frame) {
        const std::optional<Pose> motion = frame > 0 ? std::optional(motion_to(frame)) : std::nullopt;
        EXPECT_EQ(estimator.update(observe_at(frame), motion).effort.particles, options.num_particles) << frame;
    }
}

TEST(Estimator, ABudgetThatIsAmpleChangesNothingAndATightOneDoesLess) {
    const auto run = [](double budget_s) {
        EstimatorOptions options = small_options(method_default(), 1);
        options.budget_s = budget_s;
        PoseEstimator estimator(kPart, kSolver, options);
        std::vector<UpdateResult> results;
        for (int frame = 0; frame < 3; ++frame) results.push_back(estimator.update(observe_at(frame), {}));
        return results;
    };
    const std::vector<UpdateResult> without = run(0.0), ample = run(1e4), tight = run(1e-6);
    for (int frame = 0; frame < 3; ++frame) {
        EXPECT_EQ(without[frame].camera_from_object.translation, ample[frame].camera_from_object.translation);
        EXPECT_FALSE(ample[frame].effort.reduced_for_budget);
        EXPECT_TRUE(tight[frame].effort.reduced_for_budget);
        EXPECT_LT(tight[frame].effort.particles, without[frame].effort.particles);
        EXPECT_LE(tight[frame].effort.modes, 1);
    }
}

}  // namespace
}  // namespace nearpose
