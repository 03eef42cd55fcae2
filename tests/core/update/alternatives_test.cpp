// The log-odds of alternatives: a Bayes filter over the modes of the posterior.
#include "core/update/alternatives.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/core/estimator_scene.hpp"

namespace nearpose {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)

const Pose kHalfTurn{Eigen::Quaterniond(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitZ())), {0, 0, 0}};

const ObjectModel& model() {
    static const ObjectModel made = make_object_model(kPart, small_options(method_default(), 1));
    return made;
}

Mode with_evidence(const Pose& pose, double log_evidence, double log_prior = 0.0) {
    Mode mode = mode_at(pose);
    mode.log_evidence = log_evidence;
    mode.log_prior = log_prior;
    return mode;
}

// One frame: what the frames before said is added, and the alternatives to the tracked mode are remembered.
std::vector<Alternative> after_frame(const std::vector<Alternative>& before, const Pose& tracked,
                                     std::vector<Mode> modes, double kept, const ChoiceOptions& options = {}) {
    set_priors(modes, before, tracked, kept, model());
    return alternatives_to(modes.front(), modes, options, model());
}

TEST(Alternatives, LogOddsOfManyFramesAddUpToAGeometricSeries) {
    constexpr double kKept = 0.8, kEvidence = -1.5;
    std::vector<Alternative> alternatives;
    double expected = 0.0;
    for (int frame = 0; frame < 10; ++frame) {
        const Pose tracked = truth_at(frame);
        alternatives =
            after_frame(alternatives, tracked,
                        {with_evidence(tracked, 7.0), with_evidence(tracked * kHalfTurn, 7.0 + kEvidence)}, kKept);
        expected = kKept * expected + kEvidence;
        ASSERT_EQ(alternatives.size(), 1U);
        EXPECT_NEAR(alternatives.front().log_odds, expected, 1e-9) << frame;
        EXPECT_LT(angle_between(alternatives.front().tracked_from_alternative.rotation, kHalfTurn.rotation), 1e-6)
            << "the camera's motion does not change it";
    }
    EXPECT_NEAR(weight_of(alternatives), std::exp(expected) / (1.0 + std::exp(expected)), 1e-12);
}

TEST(Alternatives, AReplacementTurnsThemRound) {
    const Pose tracked = truth_at(0), other = tracked * kHalfTurn;
    std::vector<Mode> modes = {with_evidence(tracked, 0.0), with_evidence(other, 3.0)};
    set_priors(modes, {{kHalfTurn, 4.0}}, tracked, 1.0, model());
    const std::vector<Alternative> after = alternatives_to(modes[1], modes, {}, model());
    ASSERT_EQ(after.size(), 1U);
    EXPECT_NEAR(after.front().log_odds, -7.0, 1e-9) << "the mode that was tracked is now the alternative";
    EXPECT_TRUE(model().same_mode(other * after.front().tracked_from_alternative, tracked));
}

TEST(Alternatives, OnlyLikelyOnesNearbyAreRemembered) {
    const Pose tracked = truth_at(0);
    Pose elsewhere = tracked * kHalfTurn;
    elsewhere.translation.x() += 0.6 * model().diameter_m();
    ChoiceOptions options;
    EXPECT_TRUE(
        after_frame({}, tracked, {with_evidence(tracked, 0.0), with_evidence(elsewhere, 0.0)}, 1.0, options).empty())
        << "another thing in the image is no alternative";
    const std::vector<Mode> unlikely = {with_evidence(tracked, 0.0),
                                        with_evidence(tracked * kHalfTurn, options.least_log_odds - 1.0)};
    EXPECT_TRUE(after_frame({}, tracked, unlikely, 1.0, options).empty());

    std::vector<Mode> many = {with_evidence(tracked, 0.0)};
    for (int k = 1; k < 12; ++k) {
        const Eigen::AngleAxisd turn(k * M_PI / 6.0, Eigen::Vector3d::UnitZ());
        many.push_back(with_evidence(tracked * Pose{Eigen::Quaterniond(turn), {0, 0, 0}}, -0.1 * k));
    }
    const std::vector<Alternative> likeliest = after_frame({}, tracked, many, 1.0, options);
    ASSERT_EQ(static_cast<int>(likeliest.size()), options.alternatives_remembered);
    for (std::size_t k = 0; k < likeliest.size(); ++k)
        EXPECT_NEAR(likeliest[k].log_odds, -0.1 * static_cast<double>(k + 1), 1e-9) << "likeliest first";
}

TEST(Alternatives, WeightIsAShareOfTheProbability) {
    EXPECT_EQ(weight_of({}), 0.0);
    EXPECT_NEAR(weight_of({{kHalfTurn, 0.0}}), 0.5, 1e-12);
    EXPECT_NEAR(weight_of({{kHalfTurn, 0.0}, {kHalfTurn, 0.0}}), 2.0 / 3.0, 1e-12);
    EXPECT_NEAR(weight_of({{kHalfTurn, 1000.0}}), 1.0, 1e-12) << "does not overflow";
    EXPECT_NEAR(weight_of({{kHalfTurn, -1000.0}}), 0.0, 1e-12);
}

TEST(Alternatives, AModeThatWasNotKnownHasNoPrior) {
    const Pose tracked = truth_at(0);
    std::vector<Mode> modes = {with_evidence(tracked, 0.0), with_evidence(tracked * kHalfTurn, 0.0)};
    const Pose quarter{Eigen::Quaterniond(Eigen::AngleAxisd(M_PI / 2.0, Eigen::Vector3d::UnitZ())), {0, 0, 0}};
    set_priors(modes, {{quarter, -9.0}}, tracked, 1.0, model());
    EXPECT_EQ(modes[0].log_prior, 0.0);
    EXPECT_EQ(modes[1].log_prior, 0.0);
}

}  // namespace
}  // namespace nearpose
