#include "apps/error_measures/run_summary.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "core/base/random.hpp"

namespace nearpose::evaluation {
namespace {

FrameErrors frame_with(double translation_m, double rotation_rad = 0.0) {
    FrameErrors frame;
    frame.errors.emplace();
    frame.errors->translation_m = frame.errors->add_m = translation_m;
    frame.errors->rotation_rad = rotation_rad;
    return frame;
}

TEST(Statistics, OfKnownValues) {
    const Statistics statistics = statistics_of({5.0, 1.0, 2.0, 4.0, 3.0});
    EXPECT_EQ(statistics.count, 5U);
    EXPECT_DOUBLE_EQ(statistics.mean, 3.0);
    EXPECT_DOUBLE_EQ(statistics.standard_deviation, std::sqrt(2.5));
    EXPECT_DOUBLE_EQ(statistics.median, 3.0);
    EXPECT_DOUBLE_EQ(statistics.percentile_95, 4.8);
    EXPECT_DOUBLE_EQ(statistics.max, 5.0);
    EXPECT_DOUBLE_EQ(statistics_of({7.0}).standard_deviation, 0.0);
    EXPECT_DOUBLE_EQ(statistics_of({-7.0}).max, -7.0);
    EXPECT_EQ(statistics_of({}).count, 0U);
}

TEST(Arrival, FirstAndForGood) {
    const ErrorLimit limit{0.01, 0.1};
    const FrameErrors good = frame_with(0.001, 0.01), bad = frame_with(0.1, 0.01), turned = frame_with(0.001, 0.2);
    const FrameErrors none;
    const Arrival back = arrival_of({bad, good, none, good}, limit);
    EXPECT_EQ(back.first_index, 1);
    EXPECT_EQ(back.holds_from, 3);
    EXPECT_FALSE(back.stays());
    EXPECT_TRUE(arrival_of({turned, good, good}, limit).stays());
    EXPECT_EQ(arrival_of({good, good, none}, limit).holds_from, std::nullopt);
    EXPECT_EQ(arrival_of({bad, none, turned}, limit).first_index, std::nullopt);
    EXPECT_FALSE(arrival_of({}, limit).stays());
}

TEST(Summary, CountsLostAndMissingFrames) {
    const FrameErrors good = frame_with(0.001), bad = frame_with(0.1);
    FrameErrors predicted = good;
    predicted.predicted = true;
    SummaryOptions options;
    options.burn_in = 2;
    const RunSummary summary = summarise({bad, good, {}, predicted, bad, good}, 0.2, options);
    EXPECT_EQ(summary.frames, 6);
    EXPECT_EQ(summary.frames_without_pose, 1);
    EXPECT_EQ(summary.frames_predicted, 1);
    EXPECT_EQ(summary.frames_lost, 2);  // the missing one and the bad one after the arrival
    EXPECT_EQ(summary.coarse.first_index, 1);
    EXPECT_EQ(summary.translation_mm.count, 3U);  // with a pose after the burn-in
    EXPECT_DOUBLE_EQ(summary.translation_mm.max, 100.0);
    EXPECT_EQ(summary.time_ms.count, 0U);
}

TEST(Summary, AxesAreAbsoluteValues) {
    FrameErrors left = frame_with(0.002), right = frame_with(0.004);
    left.errors->translation_in_camera_m = {-0.002, 0.0, 0.0};
    right.errors->translation_in_camera_m = {0.004, 0.0, 0.0};
    right.errors->rotation_in_camera_rad = {0.0, -std::numbers::pi / 2.0, 0.0};
    const RunSummary summary = summarise({left, right}, 0.2, {0, {}, {}});
    EXPECT_DOUBLE_EQ(summary.translation_axis_mm[0].mean, 3.0);
    EXPECT_DOUBLE_EQ(summary.translation_axis_mm[0].max, 4.0);
    EXPECT_DOUBLE_EQ(summary.rotation_axis_deg[1].max, 90.0);
    EXPECT_DOUBLE_EQ(summary.rotation_axis_deg[2].max, 0.0);
}

// Errors spread evenly over 0..100 mm are below half of the thresholds on average.
TEST(Summary, AreaUnderTheRecallCurve) {
    const SummaryOptions options{0, {}, {}};
    EXPECT_DOUBLE_EQ(summarise({frame_with(0.0)}, 1.0, options).add_auc, 1.0);
    EXPECT_DOUBLE_EQ(summarise({frame_with(0.025)}, 1.0, options).add_auc, 0.75);
    EXPECT_DOUBLE_EQ(summarise({frame_with(0.3)}, 1.0, options).add_auc, 0.0);
    EXPECT_DOUBLE_EQ(summarise({frame_with(0.0), {}}, 1.0, options).add_auc, 0.5);  // no pose: never below
    std::vector<FrameErrors> frames;
    for (int i = 0; i <= 1000; ++i) frames.push_back(frame_with(1e-4 * i));
    EXPECT_NEAR(summarise(frames, 1.0, options).add_auc, 0.5, 1e-12);
    EXPECT_DOUBLE_EQ(summarise({frame_with(0.005)}, 0.2, options).add_auc_diameter, 0.75);  // of 20 mm
    EXPECT_DOUBLE_EQ(summarise({frame_with(0.005)}, 0.2, options).add_s_auc, 1.0);          // left 0 here
}

// Distances of normal draws from their mean lie inside the 90 % region nine times in ten.
TEST(Summary, QuantilesHoldNineTenthsOfNormalDraws) {
    RandomStream random(11, 0, 0, RandomPurpose::kStart);
    std::vector<FrameErrors> frames;
    for (int i = 0; i < 20000; ++i) {
        FrameErrors frame = frame_with(0.0);
        double parts[2] = {0.0, 0.0};
        for (int k = 0; k < 6; ++k) {
            const double draw = random.gaussian();
            parts[k / 3] += draw * draw;
        }
        frame.errors->mahalanobis_rotation_squared = parts[0];
        frame.errors->mahalanobis_translation_squared = parts[1];
        frame.errors->mahalanobis_squared = parts[0] + parts[1];
        frames.push_back(frame);
    }
    frames.push_back(frame_with(0.0));  // without a covariance: no part of the share
    const RunSummary summary = summarise(frames, 1.0, {0, {}, {}});
    EXPECT_EQ(summary.frames_with_covariance, 20000);
    EXPECT_NEAR(summary.inside_90.value(), 0.9, 0.01);
    EXPECT_NEAR(summary.inside_90_rotation.value(), 0.9, 0.01);
    EXPECT_NEAR(summary.inside_90_translation.value(), 0.9, 0.01);
    EXPECT_FALSE(summarise({frame_with(0.0)}, 1.0, {0, {}, {}}).inside_90.has_value());
}

TEST(Summary, OfNothing) {
    const RunSummary summary = summarise({}, 0.2, {});
    EXPECT_EQ(summary.frames, 0);
    EXPECT_DOUBLE_EQ(summary.add_auc, 0.0);
    const RunSummary within_burn_in = summarise({frame_with(0.001)}, 0.2, {});
    EXPECT_EQ(within_burn_in.translation_mm.count, 0U);
    EXPECT_TRUE(within_burn_in.coarse.stays());
}

// The ends are where a normal test of the share just does not refuse it: (share - p)^2 = z^2 p (1 - p) / n.
TEST(Proportion, IsWilsonsInterval) {
    constexpr double kZ = 1.9599639845400545;
    for (const auto& [successes, trials] : {std::pair{9, 10}, {50, 100}, {1, 7}, {199, 200}}) {
        const Interval interval = proportion(successes, trials);
        EXPECT_DOUBLE_EQ(interval.value, static_cast<double>(successes) / trials);
        for (const double p : {interval.low, interval.high}) {
            EXPECT_NEAR(std::abs(interval.value - p), kZ * std::sqrt(p * (1.0 - p) / trials), 1e-12);
        }
        EXPECT_LT(interval.low, interval.value);
        EXPECT_GT(interval.high, interval.value);
    }
    EXPECT_DOUBLE_EQ(proportion(0, 10).low, 0.0);
    EXPECT_DOUBLE_EQ(proportion(10, 10).high, 1.0);
    EXPECT_NEAR(proportion(0, 10).high, kZ * kZ / (10.0 + kZ * kZ), 1e-12);
    EXPECT_THROW(proportion(0, 0), std::invalid_argument);
    EXPECT_THROW(proportion(3, 2), std::invalid_argument);
}

TEST(MeanOverRuns, IntervalHoldsTheMeanAndShrinksWithTheRoot) {
    const auto width = [](int runs) {
        RandomStream random(2, 0, 0, RandomPurpose::kStart);
        std::vector<double> values;
        for (int i = 0; i < runs; ++i) values.push_back(5.0 + random.gaussian());
        const Interval interval = mean_over_runs(values);
        EXPECT_LT(interval.low, interval.value);
        EXPECT_GT(interval.high, interval.value);
        return interval.high - interval.low;
    };
    const double of_100 = width(100), of_400 = width(400);
    EXPECT_NEAR(of_100, 2.0 * 1.96 / std::sqrt(100.0), 0.08);
    EXPECT_NEAR(of_100 / of_400, 2.0, 0.3);
    EXPECT_DOUBLE_EQ(mean_over_runs({3.0}).low, 3.0);
    EXPECT_DOUBLE_EQ(mean_over_runs({1.0, 2.0, 6.0}).low, mean_over_runs({1.0, 2.0, 6.0}).low);  // a fixed seed
    EXPECT_THROW(mean_over_runs({}), std::invalid_argument);
}

}  // namespace
}  // namespace nearpose::evaluation
