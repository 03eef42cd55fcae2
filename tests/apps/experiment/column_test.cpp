#include "apps/experiment/column.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "apps/experiment/run_cells.hpp"

namespace nearpose::experiment {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

// A run whose frames have these translation errors along x [mm]; negative: no pose.
CellResult run_of(const std::vector<double>& errors_mm, int burn_in) {
    std::vector<evaluation::FrameErrors> frames;
    for (const double error_mm : errors_mm) {
        evaluation::FrameErrors& frame = frames.emplace_back();
        frame.frame_id = static_cast<int>(frames.size());
        if (error_mm < 0.0) continue;
        frame.errors.emplace();
        frame.errors->translation_in_camera_m = {1e-3 * error_mm, 0.0, 0.0};
        frame.errors->translation_m = frame.errors->add_m = 1e-3 * error_mm;
    }
    evaluation::SummaryOptions options;
    options.burn_in = burn_in;
    return run_result(std::move(frames), {0.004, 0.002, 0.003}, 0.2, options);
}

TEST(Figures, OfAHandMadeRun) {
    const CellResult run = run_of({50, 4, 1, 40, 2, 6}, 2);
    const Figures& figures = run.figures;
    EXPECT_DOUBLE_EQ(figures.at("translation_mean"), (1.0 + 40.0 + 2.0 + 6.0) / 4.0);
    EXPECT_DOUBLE_EQ(figures.at("translation_x_max"), 40.0);
    EXPECT_DOUBLE_EQ(figures.at("translation_y_max"), 0.0);
    EXPECT_EQ(figures.at("frames_to_arrive"), 2.0);  // the second frame
    EXPECT_EQ(figures.at("frames_to_hold"), 5.0);
    EXPECT_EQ(figures.at("frames_to_fine"), 3.0);
    EXPECT_DOUBLE_EQ(figures.at("lost"), 1.0 / 4.0);  // of the frames after the arrival
    EXPECT_EQ(figures.at("arrives"), 1.0);
    EXPECT_EQ(figures.at("stays"), 0.0);
    EXPECT_EQ(figures.at("held"), 0.0);
    EXPECT_EQ(figures.at("converged"), 1.0);  // the median of 1, 2, 6, 40 is 4
    EXPECT_DOUBLE_EQ(run.time.at("cpu_ms"), 3.0);
    EXPECT_EQ(figures.count("cpu_ms"), 0U);
    EXPECT_EQ(run_of({50, 4, 1, 3, 2, 6}, 2).figures.at("held"), 1.0);
    EXPECT_EQ(run_of({50, 4, 11, 3, 2, 6}, 2).figures.at("held"), 0.0);
}

TEST(Figures, WhatIsNotKnownIsNotZero) {
    const Figures figures = run_of({5, 5, -1, -1}, 2).figures;
    EXPECT_EQ(figures.count("translation_mean"), 0U);
    EXPECT_EQ(figures.at("converged"), 0.0);
    EXPECT_DOUBLE_EQ(figures.at("without_pose"), 0.5);
    EXPECT_EQ(run_of({90, 80, 70}, 0).figures.count("frames_to_arrive"), 0U);
}

// Letters of verdicts: a accepted and right, f accepted and wrong, c continue, l lost.
Figures verdict_figures(const std::string& letters, evaluation::Shown shown = evaluation::Shown::kPart) {
    std::vector<evaluation::FrameErrors> frames;
    for (const char letter : letters) {
        evaluation::FrameErrors& frame = frames.emplace_back();
        frame.shown = shown;
        frame.errors.emplace();
        frame.errors->translation_m = letter == 'f' ? 0.003 : 0.001;
        frame.verdict = letter == 'c' ? Verdict::kContinue : letter == 'l' ? Verdict::kLost : Verdict::kAccept;
    }
    return run_result(std::move(frames), {}, 0.2, {}).figures;
}

TEST(Figures, OfVerdictsTheBurnInCountsToo) {
    const Figures figures = verdict_figures("fcalla");  // shorter than the burn-in
    EXPECT_DOUBLE_EQ(figures.at("accepted"), 3.0 / 6.0);
    EXPECT_DOUBLE_EQ(figures.at("false_accepts"), 1.0 / 6.0);
    EXPECT_DOUBLE_EQ(figures.at("false_accepts_of_accepts"), 1.0 / 3.0);
    EXPECT_EQ(figures.at("accepted_wrong"), 1.0);
    EXPECT_DOUBLE_EQ(figures.at("lost_verdicts"), 2.0 / 6.0);
    EXPECT_DOUBLE_EQ(figures.at("accepted_of_right"), 2.0 / 5.0);  // all but the first are within half the tolerance
    EXPECT_EQ(figures.at("first_accept"), 3.0);
    const Figures cautious = verdict_figures("ccc");
    EXPECT_DOUBLE_EQ(cautious.at("false_accepts"), 0.0);
    EXPECT_EQ(cautious.count("false_accepts_of_accepts"), 0U);
    EXPECT_EQ(cautious.count("first_accept"), 0U);
    EXPECT_DOUBLE_EQ(cautious.at("accepted_of_right"), 0.0);
    EXPECT_EQ(verdict_figures("ff").count("accepted_of_right"), 0U);  // none is right
    EXPECT_EQ(run_of({1, 1}, 0).figures.count("accepted"), 0U);       // nobody gave a verdict
}

TEST(Figures, WithoutThePartEveryAcceptIsFalseAndNothingElseIsKnown) {
    const Figures figures = verdict_figures("acac", evaluation::Shown::kNothing);
    EXPECT_DOUBLE_EQ(figures.at("false_accepts"), 0.5);
    EXPECT_DOUBLE_EQ(figures.at("false_accepts_of_accepts"), 1.0);
    for (const char* name : {"arrives", "held", "stays", "first_within_3", "first_accept", "lost", "translation_mean",
                             "depth_mean", "accepted_of_right", "add_auc", "frames_to_arrive"})
        EXPECT_EQ(figures.count(name), 0U) << name;
}

TEST(Figures, TheDepthErrorAloneKeepsItsSign) {
    std::vector<evaluation::FrameErrors> frames(2);
    for (evaluation::FrameErrors& frame : frames) frame.errors.emplace();
    frames[0].errors->translation_in_camera_m.z() = -0.003;
    frames[1].errors->translation_in_camera_m.z() = 0.001;
    evaluation::SummaryOptions options;
    options.burn_in = 0;
    const Figures figures = run_result(frames, {}, 0.2, options).figures;
    EXPECT_DOUBLE_EQ(figures.at("depth_mean"), -1.0);
    EXPECT_DOUBLE_EQ(figures.at("translation_z_mean"), 2.0);
}

TEST(Figures, FirstWithinThreeFrames) {
    EXPECT_EQ(run_of({50, 50, 4, 50}, 0).figures.at("first_within_3"), 1.0);
    EXPECT_EQ(run_of({50, 50, 50, 4}, 0).figures.at("first_within_3"), 0.0);
    EXPECT_EQ(run_of({-1, -1, -1}, 0).figures.at("first_within_3"), 0.0);
}

TEST(Columns, OfVerdictsPoolRuns) {
    const std::vector<Figures> runs = {verdict_figures("aaaa"), verdict_figures("cafc"), verdict_figures("llcc")};
    const auto value = [&](const char* name) { return *entry_of(TableKind::kRun, name, runs).value; };
    EXPECT_DOUBLE_EQ(value("accepted"), 50.0);
    EXPECT_NEAR(value("false_accepts"), 25.0 / 3.0, 1e-12);
    EXPECT_DOUBLE_EQ(value("false_accepts_of_accepts"), 25.0);  // of the two runs with accepts
    EXPECT_NEAR(value("lost_verdicts"), 50.0 / 3.0, 1e-12);
    EXPECT_DOUBLE_EQ(value("first_accept"), 2.0);  // the median of 1, 2 and never
    EXPECT_FALSE(entry_of(TableKind::kRun, "frames_to_refind", runs).value);
}

TEST(Columns, PoolRuns) {
    const std::vector<Figures> runs = {run_of({1, 1, 1}, 0).figures, run_of({3, 3, 3}, 0).figures,
                                       run_of({50, 50, 50}, 0).figures, run_of({-1, -1, -1}, 0).figures};
    EXPECT_DOUBLE_EQ(*entry_of(TableKind::kRun, "translation_mean", runs).value, 18.0);
    EXPECT_DOUBLE_EQ(*entry_of(TableKind::kRun, "translation_mean_held", runs).value, 2.0);
    EXPECT_DOUBLE_EQ(*entry_of(TableKind::kRun, "translation_mean_converged", runs).value, 2.0);
    EXPECT_DOUBLE_EQ(*entry_of(TableKind::kRun, "translation_median", runs).value, 3.0);
    const tables::Entry share = entry_of(TableKind::kRun, "held", runs);
    EXPECT_DOUBLE_EQ(*share.value, 50.0);
    EXPECT_LT(*share.low, 50.0);
    EXPECT_GT(*share.high, 50.0);
    // Two of four never arrive: their median is not known.
    EXPECT_FALSE(entry_of(TableKind::kRun, "frames_to_arrive", runs).value);
    EXPECT_DOUBLE_EQ(*entry_of(TableKind::kRun, "frames_to_arrive", {runs[0], runs[1], runs[2]}).value, 1.0);
    const tables::Entry lonely = entry_of(TableKind::kRun, "translation_mean", {runs[0]});
    EXPECT_TRUE(lonely.value && !lonely.low && !lonely.high);
    EXPECT_FALSE(entry_of(TableKind::kRun, "translation_mean", {runs[3]}).value);
}

TEST(Columns, EveryNameHasAHeading) {
    for (const TableKind kind : {TableKind::kRun, TableKind::kViews}) {
        for (const std::string& name : column_names(kind)) {
            EXPECT_FALSE(heading_of(kind, name).title.empty()) << name;
            EXPECT_FALSE(entry_of(kind, name, {}).value) << name;
        }
    }
    EXPECT_THROW(heading_of(TableKind::kRun, "wrong_percent"), std::out_of_range);
}

TEST(Median, HasTheIntervalOfItsRanks) {
    std::vector<double> values;
    for (int i = 1; i <= 20; ++i) values.push_back(i);
    const tables::Entry entry = median_of(values);
    EXPECT_EQ(*entry.value, 10.5);
    EXPECT_EQ(*entry.low, 6.0);  // tables of the sign test: 20 values, ranks 6 and 15
    EXPECT_EQ(*entry.high, 15.0);
    EXPECT_FALSE(median_of({1, 2, 3, 4, 5}).low);
    EXPECT_EQ(*median_of({1, 2, 3, 4, 5, 6}).low, 1.0);  // 2 / 2^6 = 3.1 %
    EXPECT_EQ(*median_of({1, 2, 3, 4, 5, 6}).high, 6.0);
    const tables::Entry censored = median_of({1, 2, 3, 4, kNever, kNever});
    EXPECT_EQ(*censored.value, 3.5);
    EXPECT_FALSE(censored.high);
    EXPECT_FALSE(median_of({1, kNever, kNever}).value);
}

TEST(Median, IsInItsIntervalAsOftenAsPromised) {
    std::mt19937_64 random(7);
    int inside = 0;
    constexpr int kTrials = 2000;
    for (int trial = 0; trial < kTrials; ++trial) {
        std::vector<double> values;
        for (int i = 0; i < 15; ++i) values.push_back(static_cast<double>(random() >> 11) * 0x1p-53);
        const tables::Entry entry = median_of(values);
        inside += *entry.low <= 0.5 && 0.5 <= *entry.high ? 1 : 0;
    }
    EXPECT_NEAR(inside, (1.0 - 2.0 * 576.0 / 32768.0) * kTrials, 50.0);  // ranks 4 and 12: sum of C(15, 0..3) = 576
}

}  // namespace
}  // namespace nearpose::experiment
