// What the estimator does about losses, and with how much work.
#include "core/estimator.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "core/base/random.hpp"
#include "tests/core/estimator_scene.hpp"

namespace nearpose {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)

// Only what is measured within the outermost pixels of the part's box on one side: left, right, top or bottom.
DepthImage strip_of(DepthImage image, const Mask& mask, int side) {
    constexpr int kWide = 10;  // pixels
    int first_u = mask.width, last_u = 0, first_v = mask.height, last_v = 0;
    for (int pixel = 0; pixel < mask.width * mask.height; ++pixel) {
        if (mask.value[pixel] == 0) continue;
        first_u = std::min(first_u, pixel % mask.width);
        last_u = std::max(last_u, pixel % mask.width);
        first_v = std::min(first_v, pixel / mask.width);
        last_v = std::max(last_v, pixel / mask.width);
    }
    for (int pixel = 0; pixel < mask.width * mask.height; ++pixel) {
        const int u = pixel % mask.width, v = pixel / mask.width;
        const int inwards[] = {u - first_u, last_u - u, v - first_v, last_v - v};
        if (inwards[side] < 0 || inwards[side] >= kWide) image.depth_m[pixel] = 0.0F;
    }
    return image;
}

TEST(Estimator, NothingSeenYetIsNoPoseAndLaterThePredictionStandsIn) {
    PoseEstimator estimator(kPart, kSolver, small_options(method_default(), 0));
    EXPECT_EQ(estimator.update(observe_nothing(), {}).status, UpdateStatus::kNoPose);
    EXPECT_EQ(estimator.update(observe_at(0), {}).status, UpdateStatus::kEstimated);
    const UpdateResult hidden = estimator.update(observe_nothing(), motion_to(1));
    EXPECT_EQ(hidden.status, UpdateStatus::kPredicted);
    EXPECT_LT(error_m(hidden, 1), 0.001) << "moved with the camera";
    EXPECT_EQ(hidden.score, 0.0);
    const UpdateResult again = estimator.update(observe_at(2), motion_to(2));
    EXPECT_EQ(again.status, UpdateStatus::kEstimated);
    EXPECT_LT(error_m(again, 2), 0.001);
}

TEST(Estimator, SomethingElseInViewIsNotTheObject) {
    // A bare wall, and later a wall where the object was: no pose explains it, so the prediction stands in.
    const DepthImage wall{kCamera.width, kCamera.height, std::vector<float>(160 * 120, 0.9F)};
    PoseEstimator estimator(kPart, kSolver, small_options(method_default(), 0));
    const Mask somewhere{kCamera.width, kCamera.height, [] {
                             std::vector<std::uint8_t> value(160 * 120, 0);
                             for (int v = 40; v < 80; ++v) std::fill_n(value.begin() + v * 160 + 60, 40, 1);
                             return value;
                         }()};
    EXPECT_EQ(estimator.update(observe_at(0), {}).status, UpdateStatus::kEstimated);
    DepthImage tilted = wall;  // no face of the part is as large, and it is far behind
    for (std::size_t pixel = 0; pixel < tilted.depth_m.size(); ++pixel)
        tilted.depth_m[pixel] = 1.5F + 0.01F * static_cast<float>(pixel % 160);
    const UpdateResult hidden = estimator.update(make_observation(tilted, kCamera, somewhere), motion_to(1));
    EXPECT_EQ(hidden.status, UpdateStatus::kPredicted);
    EXPECT_EQ(hidden.score, 0.0);
    EXPECT_LT(error_m(hidden, 1), 0.001);
    const UpdateResult again = estimator.update(observe_at(2), motion_to(2));
    EXPECT_EQ(again.status, UpdateStatus::kEstimated);
    EXPECT_LT(error_m(again, 2), 0.001) << "the swarm was not pulled away";
}

TEST(Estimator, AWrongLockIsChallenged) {
    // Started half a turn off with a narrow spread: the paper's filter would stay there.
    PoseEstimator estimator(kPart, kSolver, small_options(method_default(), 0));
    const Pose wrong =
        perturb_about(truth_at(0), (Twist() << 0, 0, M_PI, 0, 0, 0).finished(), kPart->extent().centre_in_object());
    estimator.reset(wrong, {0.01, 0.001});
    UpdateResult result;
    for (int frame = 0; frame < 4; ++frame)
        result = estimator.update(observe_at(frame), frame > 0 ? std::optional(motion_to(frame)) : std::nullopt);
    EXPECT_LT(error_m(result, 3), 0.001);
    EXPECT_LT(angle_between(result.camera_from_object.rotation, truth_at(3).rotation), 0.02);
}

TEST(Estimator, FindsTheObjectAgainWhereItWasPutDown) {
    PoseEstimator estimator(kPart, kSolver, small_options(method_default(), 0));
    estimator.update(observe_at(0), {});
    const Pose elsewhere = perturb_about(truth_at(0), (Twist() << 0, 0, 2.0, 0.05, -0.04, 0.02).finished(),
                                         kPart->extent().centre_in_object());
    Mask mask;
    const DepthImage image = test::render(*kPart, elsewhere, kCamera, 0.9F, &mask);
    UpdateResult result;
    for (int frame = 0; frame < 5; ++frame)
        result = estimator.update(make_observation(image, kCamera, mask), Pose::identity());
    EXPECT_LT(angle_between(result.camera_from_object.rotation, elsewhere.rotation), 0.02);
    EXPECT_EQ(result.verdict, Verdict::kAccept);
}

TEST(Estimator, AfterFramesOfNonsenseItIsBackInTheFirstRightOne) {
    PoseEstimator estimator(kPart, kSolver, small_options(method_default(), 0));
    for (int frame = 0; frame < 7; ++frame)
        estimator.update(observe_at(frame), frame > 0 ? std::optional(motion_to(frame)) : std::nullopt);
    DepthImage wall{kCamera.width, kCamera.height, std::vector<float>(160 * 120, 0.45F)};
    for (int frame = 7; frame < 10; ++frame)
        EXPECT_NE(estimator.update(make_observation(wall, kCamera, {}), motion_to(frame)).verdict, Verdict::kAccept);
    const UpdateResult back = estimator.update(observe_at(10), motion_to(10));
    EXPECT_LT(error_m(back, 10), 0.002);
}

TEST(Estimator, WhileOneModeHoldsFewParticlesDoAndAfterALossAllAreBack) {
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

TEST(Estimator, AnEstimateThatConvincesIsConfirmedWithFewerRaysButAllParticlesAndRivals) {
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

TEST(Estimator, WhatTheArmForetoldIsFittedAtOnceAndOnlyThen) {
    // Once one mode holds: one solve a particle, none for the mode, unless the prediction and the image disagree.
    PoseEstimator estimator(kPart, kSolver, small_options(method_default(), 0));
    UpdateResult result;
    for (int frame = 0; frame < 8; ++frame)
        result = estimator.update(observe_at(frame), frame > 0 ? std::optional(motion_to(frame)) : std::nullopt);
    EXPECT_EQ(result.counts.solves, result.effort.particles);
    EXPECT_LT(error_m(result, 7), 0.001);
    // Two centimetres of motion that the arm does not tell.
    result = estimator.update(observe_at(8), Pose::identity());
    EXPECT_GT(result.counts.solves, result.effort.particles);
    EXPECT_LT(error_m(result, 8), 0.001);
    // And nothing is known of it.
    result = estimator.update(observe_at(9), {});
    EXPECT_GE(result.counts.solves, method_default().step.rounds * result.effort.particles);
    EXPECT_LT(error_m(result, 9), 0.001);
}

TEST(Estimator, WhatDoesNotConvinceIsDoubtedAtFirstAndNowAndThen) {
    // Every eighth pixel of the part lies behind it, as where a model is not quite the part.
    Mask mask;
    DepthImage image = render(*kPart, truth_at(0), kCamera, 0.9F, &mask);
    int on_part = 0;
    for (std::size_t pixel = 0; pixel < mask.value.size(); ++pixel)
        if (mask.value[pixel] != 0 && on_part++ % 8 == 0) image.depth_m[pixel] += 0.05F;
    const Observation observation = make_observation(image, kCamera, mask);
    for (const bool doubts : {true, false}) {
        EstimatorOptions options = small_options(method_default(), 0);
        options.method.relocalisation.unverified = doubts;
        PoseEstimator estimator(kPart, kSolver, options);
        std::vector<int> searched;
        for (int frame = 0; frame < 34; ++frame) {
            const UpdateResult result = estimator.update(observation, Pose::identity());
            EXPECT_GT(result.pixels.agreement(), 0.8);
            EXPECT_LT(result.pixels.agreement(), 0.93);
            EXPECT_EQ(result.verdict, Verdict::kContinue);
            EXPECT_LT(error_m(result, 0), 0.002) << frame;
            if (result.effort.starts > 0) searched.push_back(frame);
        }
        EXPECT_EQ(searched, doubts ? (std::vector<int>{0, 1, 2, 3, 4, 16, 32}) : std::vector<int>{0});
    }
}

TEST(Estimator, LittleThatIsSeenDoesNotOverturnWhatWasAcceptedAndAllOfItDoes) {
    // The part was moved by a fifth of its size. Where all but a corner of it is hidden, that may as well be an error
    // of the sensor.
    const Pose moved =
        Pose{Eigen::Quaterniond::Identity(), {0.2 * kPart->extent().diameter_m(), 0, 0.01}} * truth_at(0);
    Mask mask;
    const DepthImage all = render(*kPart, moved, kCamera, 0.9F, &mask);
    Mask corner = mask;
    int left = 60;
    for (std::uint8_t& value : corner.value) value = value != 0 && left-- > 0 ? value : 0;
    for (const bool whole : {false, true}) {
        PoseEstimator estimator(kPart, kSolver, small_options(method_default(), 0));
        for (int frame = 0; frame < 6; ++frame)
            EXPECT_EQ(estimator.update(observe_at(0), Pose::identity()).verdict, Verdict::kAccept) << frame;
        const Observation observation = make_observation(all, kCamera, whole ? mask : corner);
        estimator.update(observation, Pose::identity());
        const UpdateResult result = estimator.update(observation, Pose::identity());  // after a search
        const Eigen::Vector3d centre = kPart->extent().centre_in_object();
        const Pose expected = whole ? moved : truth_at(0);
        EXPECT_LT((result.camera_from_object * centre - expected * centre).norm(), 0.003) << whole;
        EXPECT_LT(angle_between(result.camera_from_object.rotation, expected.rotation), 0.05) << whole;
    }
}

TEST(Estimator, AStripInViewDoesNotPullThePoseOffWhatTheArmForetold) {
    // Of an accepted part nothing but a noisy strip along one of its sides is measured any more: too little for a fit,
    // which would slide along it.
    Mask mask;
    const DepthImage all = render(*kPart, truth_at(0), kCamera, 0.9F, &mask);
    for (const int side : {0, 1, 2, 3}) {
        PoseEstimator estimator(kPart, kSolver, small_options(method_default(), 0));
        for (int frame = 0; frame < 6; ++frame)
            EXPECT_EQ(estimator.update(observe_at(0), Pose::identity()).verdict, Verdict::kAccept) << frame;
        for (int frame = 0; frame < 8; ++frame) {
            DepthImage strip = strip_of(all, mask, side);
            RandomStream random(7, frame, side, RandomPurpose::kStart);
            for (float& depth_m : strip.depth_m) depth_m *= static_cast<float>(1.0 + 0.006 * random.gaussian());
            const Observation observation = make_observation(strip, kCamera, std::nullopt);
            const UpdateResult result = estimator.update(observation, Pose::identity());
            EXPECT_EQ(result.status, UpdateStatus::kEstimated) << "side " << side << ", frame " << frame;
            EXPECT_LT(error_m(result, 0), 0.001) << "side " << side << ", frame " << frame;
        }
    }
}

TEST(Estimator, APartThatStartsToMoveIsFollowedInTheFrameItself) {
    // By little enough that it is the same mode, and by much more than the track was off: the arm stands still.
    PoseEstimator estimator(kPart, kSolver, small_options(method_default(), 0));
    for (int frame = 0; frame < 6; ++frame)
        EXPECT_EQ(estimator.update(observe_at(0), Pose::identity()).verdict, Verdict::kAccept) << frame;
    const double step_m = 0.025 * kPart->extent().diameter_m();
    const Eigen::Vector3d centre = kPart->extent().centre_in_object();
    Pose moved = truth_at(0);
    for (int frame = 0; frame < 3; ++frame) {
        moved.translation.x() += step_m;
        Mask mask;
        const DepthImage image = render(*kPart, moved, kCamera, 0.9F, &mask);
        const UpdateResult result = estimator.update(make_observation(image, kCamera, mask), Pose::identity());
        EXPECT_LT((result.camera_from_object * centre - moved * centre).norm(), 0.2 * step_m) << frame;
    }
}

TEST(Estimator, APartThatMovesAgainstTheArmsWordIsFittedFromWhereItIs) {
    // The arm says that it stands still, the part turns and drifts, as on a conveyor: the particles are pulled there
    // from afar, and the refinement's narrow gates would not pull the prediction.
    PoseEstimator estimator(kPart, kSolver, small_options(method_default(), 0));
    Pose truth = truth_at(0);
    const Eigen::Vector3d centre = kPart->extent().centre_in_object();
    const double step_m = 0.028 * kPart->extent().diameter_m();
    for (int frame = 0; frame < 7; ++frame) {
        Mask mask;
        const DepthImage image = render(*kPart, truth, kCamera, 0.9F, &mask);
        const UpdateResult result = estimator.update(make_observation(image, kCamera, mask), Pose::identity());
        EXPECT_LT((result.camera_from_object * centre - truth * centre).norm(), 0.00015) << frame;
        EXPECT_LT(angle_between(result.camera_from_object.rotation, truth.rotation), 0.002) << frame;
        truth = perturb_about(truth, (Twist() << 0, 0, 0.12, 0.7 * step_m, -0.7 * step_m, 0).finished(), centre);
    }
}

TEST(Estimator, AJoltThatNobodyMeasuredIsFollowedInTheFrameItself) {
    EstimatorOptions options = small_options(method_default(), 0);
    options.num_particles = 100;
    PoseEstimator estimator(kPart, kSolver, options);
    Pose truth = truth_at(0);
    double worst_m = 0.0;
    for (int frame = 0; frame < 20; ++frame) {
        constexpr int kHeld = 8;  // one mode holds by then, and few particles are left
        if (frame >= kHeld)
            truth.translation.x() += (frame % 2 == 0 ? 1.0 : -1.0) * 0.10 * kPart->extent().diameter_m();
        Mask mask;
        const DepthImage image = test::render(*kPart, truth, kCamera, 0.9F, &mask);
        const UpdateResult result = estimator.update(make_observation(image, kCamera, mask), {});
        const Eigen::Vector3d centre = kPart->extent().centre_in_object();
        if (frame >= kHeld) worst_m = std::max(worst_m, (result.camera_from_object * centre - truth * centre).norm());
    }
    EXPECT_LT(worst_m, 0.003);
}

TEST(Estimator, AFixedNumberOfParticlesStays) {
    EstimatorOptions options = small_options(method_default(), 0);
    options.method.effort.min_particles = options.num_particles;
    PoseEstimator estimator(kPart, kSolver, options);
    for (int frame = 0; frame < 8; ++frame)
        EXPECT_EQ(estimator.update(observe_at(frame), {}).effort.particles, options.num_particles) << frame;
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
