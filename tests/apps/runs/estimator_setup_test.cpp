#include "apps/runs/estimator_setup.hpp"

#include <gtest/gtest.h>

#include "tests/apps/support/tiny_scene.hpp"

namespace nearpose::program {
namespace {

TEST(EstimatorSetup, LeavesOutWhatIsAsked) {
    EstimatorSetup setup;
    setup.method = "paper";
    setup.rounds = 2;
    setup.consensus_draws = 0;
    setup.overlap = false;
    const Method method = make_method(setup);
    EXPECT_EQ(method.step.rounds, 2);
    EXPECT_EQ(method.step.consensus_draws, 0);
    EXPECT_FALSE(method.scale_by_overlap);
    EstimatorSetup untouched;
    untouched.method = "paper";
    EXPECT_EQ(make_method(untouched).step.rounds, method_paper().step.rounds);
    EXPECT_TRUE(make_method(untouched).scale_by_overlap);
}

TEST(EstimatorSetup, LeavesOneNamedPartOut) {
    const auto without = [](const char* part) {
        EstimatorSetup setup;
        setup.without = part;
        return make_method(setup);
    };
    const Method whole = without("nothing");
    EXPECT_TRUE(whole.fusion && whole.refinement.outline && whole.search.initialisation == Initialisation::kPairs);
    EXPECT_GT(whole.hypotheses.alternatives, 0);
    EXPECT_FALSE(without("fine_fit").fusion);
    EXPECT_FALSE(without("outline").refinement.outline);
    EXPECT_EQ(without("depths").free_space_depth_diameters, 0.0);
    EXPECT_EQ(without("shortlist").preselection.tried, 0);
    EXPECT_EQ(without("pairs").search.initialisation, Initialisation::kSurface);
    EXPECT_EQ(without("rivals").hypotheses.alternatives, 0);
    EXPECT_LT(without("presence").verification.min_log_odds_present, -1e6);
    EXPECT_EQ(without("presence").preselection.presence_rays, 0);
    EXPECT_EQ(without("memory").choice.log_odds_kept, 0.0);
    EXPECT_EQ(without("shared_errors").verification.shared_errors_allowed, 0.0);
    EXPECT_GT(whole.verification.shared_errors_allowed * whole.choice.log_odds_kept, 0.0);
    EXPECT_TRUE(whole.arm_check.on && whole.repeated_image.on);
    EXPECT_FALSE(without("arm_check").arm_check.on);
    EXPECT_FALSE(without("repeated_image").repeated_image.on);
    EXPECT_FALSE(without("confidence").choice.accepted_evidence);
    EXPECT_FALSE(without("doubts").relocalisation.low_agreement);
    EXPECT_THROW(without("wheels"), std::invalid_argument);
    EstimatorSetup paper;
    paper.method = "paper";
    paper.without = "outline";
    EXPECT_THROW(make_method(paper), std::invalid_argument) << "it has no such part";
}

TEST(EstimatorSetup, WithoutGradientNothingIsSolved) {
    for (const char* name : {"paper", "default"}) {
        EstimatorSetup setup;
        setup.method = name;
        setup.gradient = false;
        setup.rounds = 0;
        setup.particles = 3;
        setup.threads = 1;
        PoseEstimator estimator = make_estimator(setup, make_view_generator(setup, program_tests::unsymmetric_part()));
        const DepthImage depth{40, 30, std::vector<float>(1200, 0.5F)};
        const Observation observation = make_observation(depth, {40, 30, 40.0, 40.0, 19.5, 14.5}, std::nullopt);
        const UpdateResult result = estimator.update(observation, std::nullopt);
        EXPECT_EQ(result.status, UpdateStatus::kEstimated);
        EXPECT_EQ(result.counts.solves, 0) << name;
        EXPECT_GT(result.counts.view_points, 0) << name;
    }
}

TEST(EstimatorSetup, RefusesWhatDoesNotGoTogether) {
    EstimatorSetup overlap, rounds, still, samples, residual;
    overlap.overlap = true;
    EXPECT_THROW(make_method(overlap), std::invalid_argument);
    rounds.rounds = 0;
    EXPECT_THROW(make_method(rounds), std::invalid_argument);
    still.gradient = false;
    still.residual = "point";
    EXPECT_THROW(make_method(still), std::invalid_argument);
    samples.view_samples = 100;
    EXPECT_THROW(make_view_generator(samples, program_tests::unsymmetric_part()), std::invalid_argument);
    residual.residual = "line";
    EXPECT_THROW(make_solver(residual), std::invalid_argument);
}

}  // namespace
}  // namespace nearpose::program
