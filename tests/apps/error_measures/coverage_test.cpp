#include "apps/error_measures/coverage.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>

#include "apps/error_measures/run_summary.hpp"
#include "apps/evaluate/error_curves.hpp"
#include "apps/evaluate/summary_text.hpp"
#include "core/base/random.hpp"

namespace nearpose::evaluation {
namespace {

// Of chi-square of 6 degrees of freedom, at kCoverageLevels.
constexpr std::array kQuantiles = {5.348120627447116, 10.644640675668420, 16.811893829770927};

FrameErrors frame_at(double distance_m, double squared) {
    FrameErrors frame;
    frame.visibility = Visibility{distance_m, 1e-6, std::nullopt};
    frame.errors.emplace();
    frame.errors->mahalanobis_squared = squared;
    return frame;
}

Matrix6d some_covariance() {
    RandomStream random(3, 0, 0, RandomPurpose::kStart);
    Matrix6d factor;
    for (int i = 0; i < 36; ++i) factor(i / 6, i % 6) = random.gaussian();
    Twist sigmas;
    sigmas << 0.004, 0.003, 0.006, 0.0004, 0.0003, 0.0008;  // rad, m
    const Matrix6d mixed = factor * factor.transpose() / 6.0 + 0.2 * Matrix6d::Identity();
    return sigmas.asDiagonal() * mixed * sigmas.asDiagonal();
}

// Frames whose errors are drawn from some_covariance(), which the estimate states `stated` times.
void add_drawn(int count, double distance_m, double stated, std::vector<FrameErrors>& frames) {
    const std::vector<Eigen::Vector3d> corners = {{0.0, 0.0, 0.0}, {0.1, 0.0, 0.0}, {0.0, 0.2, 0.1}};
    data_set::ModelInfo info;
    info.box_max_in_object_m = {0.1, 0.2, 0.1};
    const ModelShape shape = shape_of(info, corners);
    const Matrix6d covariance = some_covariance();
    const Matrix6d root = covariance.llt().matrixL();
    RandomStream random(8, static_cast<std::uint64_t>(1e3 * distance_m), 0, RandomPurpose::kStart);
    for (int i = 0; i < count; ++i) {
        Twist draw, place;
        for (int k = 0; k < 6; ++k) draw[k] = random.gaussian();
        for (int k = 0; k < 6; ++k) place[k] = random.gaussian();
        TrueFrame truth;
        truth.camera_from_object = exp(place);
        truth.visibility = Visibility{distance_m, 1e-6, std::nullopt};
        EstimatedFrame estimate;
        estimate.camera_from_object = truth.camera_from_object * exp(Twist(-(root * draw)));
        estimate.covariance = stated * covariance;
        frames.push_back(frame_errors(truth, estimate, shape, {64, 48, 60.0, 60.0, 31.5, 23.5}));
    }
}

TEST(Coverage, OfAKnownCovarianceIsTheClosedForm) {
    constexpr int kFrames = 4000;
    std::vector<FrameErrors> frames;
    add_drawn(kFrames, 0.25, 1.0, frames);
    add_drawn(kFrames, 0.45, 0.25, frames);  // half of the true standard deviations
    add_drawn(kFrames, 0.65, 4.0, frames);   // twice
    const std::vector<CoverageBin> bins = coverage_by_distance(frames);
    ASSERT_EQ(bins.size(), 3U);
    for (std::size_t level = 0; level < kCoverageLevels.size(); ++level) {
        const double stated[] = {1.0, 0.25, 4.0};
        for (std::size_t bin = 0; bin < 3; ++bin) {
            const double expected = chi_square_of_6(stated[bin] * kQuantiles[level]);
            const double deviation = std::sqrt(expected * (1.0 - expected) / kFrames);
            EXPECT_EQ(bins[bin].coverage.frames, kFrames);
            EXPECT_NEAR(bins[bin].coverage.share(level), expected, 4.0 * deviation + 1e-3) << bin << " " << level;
        }
    }
}

// The quantiles of the middles of equal shares: as many lie inside each region as should.
TEST(Coverage, OfQuantilesIsExact) {
    std::vector<FrameErrors> frames;
    for (int i = 0; i < 200; ++i) {
        double low = 0.0, high = 1e3;
        for (int step = 0; step < 80; ++step) {
            const double middle = 0.5 * (low + high);
            (chi_square_of_6(middle) < (i + 0.5) / 200.0 ? low : high) = middle;
        }
        frames.push_back(frame_at(0.3, low));
    }
    const Coverage coverage = coverage_of(frames);
    EXPECT_EQ(coverage.frames, 200);
    EXPECT_EQ(coverage.inside, (std::array{100, 180, 198}));
    EXPECT_DOUBLE_EQ(coverage.share(1), 0.9);
    EXPECT_DOUBLE_EQ(Coverage{}.share(0), 0.0);
}

TEST(Coverage, CountsOnlyFramesWithACovariance) {
    FrameErrors far, without_covariance;
    far.errors.emplace().mahalanobis_squared = 1.0;
    without_covariance.visibility = Visibility{0.3, 1e-6, std::nullopt};
    without_covariance.errors.emplace();
    const std::vector<FrameErrors> frames = {far, without_covariance, {}, frame_at(0.3, 1.0), frame_at(0.3, 30.0)};
    EXPECT_EQ(coverage_of(frames).frames, 3);  // the distance does not matter
    EXPECT_EQ(coverage_of(frames).inside, (std::array{2, 2, 2}));
    const auto bins = coverage_by_distance(frames);
    ASSERT_EQ(bins.size(), 1U);
    EXPECT_EQ(bins[0].coverage.frames, 2);
    EXPECT_TRUE(coverage_by_distance({far, without_covariance, {}}).empty());
}

TEST(CoverageByDistance, BinsAreOfARoundWidth) {
    // 180 to 610 mm: nine bins of 50 mm would be needed, so they are 100 mm wide; none is in 400 to 500 mm.
    const auto bins = coverage_by_distance(
        {frame_at(0.61, 1.0), frame_at(0.18, 1.0), frame_at(0.2, 1.0), frame_at(0.3, 1.0), frame_at(0.39, 1.0)});
    ASSERT_EQ(bins.size(), 4U);
    const double from_mm[] = {100.0, 200.0, 300.0, 600.0};
    const int frames[] = {1, 1, 2, 1};
    for (std::size_t i = 0; i < bins.size(); ++i) {
        EXPECT_NEAR(1e3 * bins[i].from_m, from_mm[i], 1e-9);
        EXPECT_NEAR(1e3 * (bins[i].to_m - bins[i].from_m), 100.0, 1e-9);
        EXPECT_EQ(bins[i].coverage.frames, frames[i]);
    }
    const auto still = coverage_by_distance({frame_at(0.3, 1.0), frame_at(0.3, 9.0)});
    ASSERT_EQ(still.size(), 1U);
    EXPECT_NEAR(1e3 * still[0].from_m, 300.0, 1e-9);
    EXPECT_NEAR(1e3 * still[0].to_m, 301.0, 1e-9);
}

TEST(CoverageByDistance, IsDrawnWithItsTarget) {
    std::vector<FrameErrors> frames;
    for (int i = 0; i < 40; ++i) frames.push_back(frame_at(0.2 + 0.01 * i, 0.5 * i));
    const auto plots = calibration_curves(frames);
    ASSERT_EQ(plots.size(), 2U);
    const pictures::CurvePlot& plot = plots[1];
    ASSERT_EQ(plot.curves.size(), 3U);
    ASSERT_EQ(plot.nominal.size(), 3U);
    EXPECT_EQ(plot.curves[0].label, "90 % region");
    EXPECT_DOUBLE_EQ(plot.nominal[0], 0.9);
    EXPECT_DOUBLE_EQ(plot.target.low, 0.85);
    EXPECT_DOUBLE_EQ(plot.target.high, 0.95);
    EXPECT_TRUE(plot.y_is_share);
    const auto bins = coverage_by_distance(frames);
    ASSERT_EQ(plot.curves[0].bins.size(), bins.size());
    for (std::size_t i = 0; i < bins.size(); ++i) {
        const CurveBin& drawn = plot.curves[0].bins[i];
        EXPECT_NEAR(drawn.x, 500.0 * (bins[i].from_m + bins[i].to_m), 1e-9);  // mm
        EXPECT_DOUBLE_EQ(drawn.median, bins[i].coverage.share(1));
        EXPECT_LE(drawn.percentile_25, drawn.median);
        EXPECT_GE(drawn.percentile_75, drawn.median);
    }
    for (FrameErrors& frame : frames) frame.visibility.reset();
    EXPECT_EQ(calibration_curves(frames).size(), 1U);  // against p alone
}

TEST(CoverageByDistance, IsATableOfTheSummary) {
    std::vector<FrameErrors> frames;
    for (int i = 0; i < 10; ++i) frames.push_back(frame_at(i < 4 ? 0.255 : 0.47, i == 0 ? 12.0 : i < 3 ? 7.0 : 1.0));
    const SummaryOptions options{0, {}, {}};
    const std::string text = summary_text({}, frames, summarise(frames, 0.2, options), options);
    for (const char* row : {"inside the region of          50 %      90 %      99 %    frames   of 90 %: 95 % interval",
                            "  250 to 300 mm             25.0 %    75.0 %   100.0 %         4   30.1 % to 95.4 %",
                            "  450 to 500 mm            100.0 %   100.0 %   100.0 %         6   61.0 % to 100.0 %",
                            "  all distances             70.0 %    90.0 %   100.0 %        10   59.6 % to 98.2 %"}) {
        EXPECT_NE(text.find(row), std::string::npos) << row << "\n" << text;
    }
    EXPECT_EQ(text.find("verdicts"), std::string::npos) << text;
    for (FrameErrors& frame : frames) frame.errors->mahalanobis_squared.reset();
    const std::string without = summary_text({}, frames, summarise(frames, 0.2, options), options);
    EXPECT_EQ(without.find("region"), std::string::npos) << without;
}

}  // namespace
}  // namespace nearpose::evaluation
