// When another mode replaces the tracked one, and what the image must show of it.
#include "core/update/choose.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "core/update/pose_evidence.hpp"
#include "tests/core/estimator_scene.hpp"

namespace nearpose {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)

TEST(Choose, WhatAChallengerNeedsToReplaceTheTrackedMode) {
    ChoiceOptions options;
    options.challenge_nats = 6.0;
    Lock accepted;
    accepted.accepted_evidence = 80.0;  // [nats * pixels^2]
    struct Row {
        std::string when;
        double ahead_nats;
        int stride;
        Lock lock;
        bool expected;
    };
    const std::vector<Row> table = {
        {"nothing was accepted, by less than the margin", 5.9, 2, Lock{}, false},
        {"nothing was accepted, by more than the margin", 6.1, 2, Lock{}, true},
        {"an accepted pose, by less than its evidence on these rays", 19.9, 2, accepted, false},
        {"an accepted pose, by more", 20.1, 2, accepted, true},
        {"an accepted pose on fewer rays, of which the margin is more", 5.9, 4, accepted, false},
        {"an accepted pose on fewer rays", 6.1, 4, accepted, true},
    };
    for (const Row& row : table)
        EXPECT_EQ(overturns(100.0 + row.ahead_nats, 100.0, row.stride, row.lock, options), row.expected) << row.when;
}

// The log-odds that the part is there, and what a mode with evidence 0 is left with, where it is and on the bare wall.
struct Penalty {
    double at_part = 0.0, on_wall = 0.0;
};

Penalty penalty_of(const EstimatorOptions& options) {
    const ObjectModel model = make_object_model(kPart, options);
    const Observation observation = observe_without_mask(0);
    const Frame frame{model, *kSolver, options, observation, std::nullopt, 1};
    Pose on_wall = truth_at(0);  // its largest face lies on the wall
    on_wall.rotation = Eigen::Quaterniond(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()));
    on_wall.translation = Eigen::Vector3d(-0.2, 0.1, 0.99);
    std::vector<Mode> modes = {mode_at(truth_at(0)), mode_at(on_wall)};
    penalise_absent(modes, options.method.refinement, frame);
    return {modes[0].log_evidence, modes[1].log_evidence};
}

TEST(Choose, AModeThatPlanesExplainBetterIsPenalisedAndTheTruthIsNot) {
    const Penalty penalty = penalty_of(small_options(method_default(), 1));
    EXPECT_EQ(penalty.at_part, 0.0);
    EXPECT_LT(penalty.on_wall, -1.0);
    const Penalty threads = penalty_of(small_options(method_default(), 3));
    EXPECT_EQ(threads.on_wall, penalty.on_wall) << "the same bits for any number of threads";
}

TEST(PoseEvidence, WhatNeighboursAreOffTogetherIsNoContradiction) {
    // The image of the part is wavy by 6 mm, as a sensor's or a casting's surface may be; a hole of 40 mm is none of
    // it.
    const EstimatorOptions options = small_options(method_default(), 1);
    const ObjectModel model = make_object_model(kPart, options);
    const auto agreement = [&](bool with_hole, double shared_sigma_m) {
        Mask mask;
        DepthImage image = render(*kPart, truth_at(0), kCamera, 0.9F, &mask);
        for (int pixel = 0; pixel < 160 * 120; ++pixel) {
            if (mask.value[pixel] == 0) continue;
            const double phase = 0.08 * (pixel % 160 + pixel / 160);
            image.depth_m[pixel] += static_cast<float>(0.006 * std::sin(phase));
            if (with_hole && (pixel / 160) % 40 < 12) image.depth_m[pixel] += 0.04F;
        }
        const Observation observation = make_observation(image, kCamera, mask);
        const Frame frame{model, *kSolver, options, observation, std::nullopt, 1};
        const ObservedGrid observed = observe(observation, {0, 0, 1, kCamera.width, kCamera.height});
        const StepContext context = frame.context(observed, options.method.step);
        return evidence_at(truth_at(0), context, options.method.refinement, frame, shared_sigma_m).judged.agreement();
    };
    EXPECT_LT(agreement(false, 0.0), 0.9);
    EXPECT_GT(agreement(false, 0.004), 0.97);
    EXPECT_LT(agreement(true, 0.004), 0.85) << "what is far off still contradicts";
}

TEST(Choose, ThePenaltyCanBeLeftOut) {
    EstimatorOptions options = small_options(method_default(), 1);
    options.method.preselection.presence_rays = 0;
    EXPECT_EQ(penalty_of(options).on_wall, 0.0);
}

}  // namespace
}  // namespace nearpose
