#include "apps/error_measures/curve.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "apps/data_set/png_file.hpp"
#include "apps/error_measures/coverage.hpp"
#include "apps/evaluate/error_curves.hpp"
#include "core/base/random.hpp"
#include "tests/apps/support/test_files.hpp"

namespace nearpose::evaluation {
namespace {

TEST(Curve, BinsOfEqualWidth) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    const std::vector<CurvePoint> points = {{0.0, 1.0}, {0.5, 2.0},  {0.9, 9.0},   {3.0, 4.0},  {4.0, 5.0},
                                            {4.5, 7.0}, {-0.1, 8.0}, {2.5, kNone}, {kNone, 3.0}};
    const Curve curve = curve_of("a", points, 0.0, 4.0, 4);
    ASSERT_EQ(curve.bins.size(), 2U);  // 1..2 and 2..3 are empty; 4 is in the last
    EXPECT_DOUBLE_EQ(curve.bins[0].x, 0.5);
    EXPECT_EQ(curve.bins[0].count, 3);
    EXPECT_DOUBLE_EQ(curve.bins[0].median, 2.0);
    EXPECT_DOUBLE_EQ(curve.bins[0].percentile_25, 1.5);
    EXPECT_DOUBLE_EQ(curve.bins[0].percentile_75, 5.5);
    EXPECT_DOUBLE_EQ(curve.bins[1].x, 3.5);
    EXPECT_EQ(curve.bins[1].count, 2);
    EXPECT_DOUBLE_EQ(curve.bins[1].median, 4.5);
    EXPECT_THROW(curve_of("a", points, 0.0, 0.0, 4), std::invalid_argument);
    EXPECT_THROW(curve_of("a", points, 0.0, 1.0, 0), std::invalid_argument);
    EXPECT_THROW(curve_of("a", points, 0.0, 1.0, 4, true), std::invalid_argument);
}

TEST(Curve, BinsOfEqualRatio) {
    const Curve curve = curve_of("a", {{2.0, 1.0}, {50.0, 2.0}, {100.0, 4.0}, {0.5, 9.0}}, 1.0, 100.0, 2, true);
    ASSERT_EQ(curve.bins.size(), 2U);
    EXPECT_NEAR(curve.bins[0].x, std::sqrt(10.0), 1e-12);
    EXPECT_NEAR(curve.bins[1].x, std::sqrt(1000.0), 1e-12);
    EXPECT_EQ(curve.bins[1].count, 2);
    EXPECT_DOUBLE_EQ(curve.bins[1].median, 3.0);
}

std::vector<FrameErrors> frames_near_to_far(int count) {
    RandomStream random(4, 0, 0, RandomPurpose::kStart);
    std::vector<FrameErrors> frames;
    for (int i = 0; i < count; ++i) {
        FrameErrors& frame = frames.emplace_back();
        frame.frame_id = i;
        frame.visibility = Visibility{0.15 + 0.5 * i / count, 1e-3 * (1.0 + i), std::nullopt};
        frame.errors.emplace();
        frame.errors->translation_m = 1e-3 * random.uniform();
        double squared = 0.0;
        for (int k = 0; k < 6; ++k) squared += std::pow(random.gaussian(), 2.0);
        frame.errors->mahalanobis_squared = squared;
    }
    return frames;
}

TEST(ErrorCurves, OneAPairOfQuantitiesThatIsKnown) {
    std::vector<FrameErrors> frames = frames_near_to_far(60);
    EXPECT_EQ(error_curves(frames).size(), 4U);  // against distance and volume
    for (FrameErrors& frame : frames) frame.visibility->visible_fraction = 0.5;
    EXPECT_EQ(error_curves(frames).size(), 6U);
    frames.resize(1);  // all at one place
    const auto plots = error_curves(frames);
    ASSERT_EQ(plots.size(), 6U);
    EXPECT_EQ(plots[0].curves[0].bins.size(), 1U);
    frames[0].visibility.reset();
    EXPECT_TRUE(error_curves(frames).empty());
}

TEST(Calibration, OfNormalDrawsIsTheDiagonal) {
    const auto plots = calibration_curves(frames_near_to_far(4000));
    ASSERT_EQ(plots.size(), 2U);            // against p and against distance
    ASSERT_EQ(plots[0].curves.size(), 4U);  // all, and three distances
    for (const Curve& curve : plots[0].curves) {
        for (const CurveBin& bin : curve.bins) EXPECT_NEAR(bin.median, bin.x, 0.06) << curve.label;
    }
    EXPECT_TRUE(calibration_curves({}).empty());
}

TEST(Calibration, ChiSquareOfSixDegrees) {
    EXPECT_DOUBLE_EQ(chi_square_of_6(0.0), 0.0);
    EXPECT_NEAR(chi_square_of_6(10.644640675668420), 0.9, 1e-12);
    EXPECT_NEAR(chi_square_of_6(5.348120627447116), 0.5, 1e-9);
}

TEST(CurvePlot, IsAPictureAsTallAsItsPlots) {
    const auto folder = data_set::testing_files::new_folder();
    auto plots = error_curves(frames_near_to_far(60));
    pictures::write_curve_plots(folder / "four.png", plots);
    const data_set::ImageSize four = data_set::read_png_size(folder / "four.png");
    EXPECT_EQ(four.width, 900);
    plots.resize(1);
    plots[0].curves.push_back({"empty", {}});  // takes no room but in the legend
    pictures::write_curve_plots(folder / "one.png", plots);
    EXPECT_LT(3 * data_set::read_png_size(folder / "one.png").height, four.height);
    plots[0].curves = {{"one place", {{3.0, 1, 2.0, 2.0, 2.0, 2.0}}}};
    for (const bool logarithmic : {false, true}) {
        plots[0].x_logarithmic = logarithmic;
        EXPECT_NO_THROW(pictures::write_curve_plots(folder / "place.png", plots));
    }
    EXPECT_THROW(pictures::write_curve_plots(folder / "none.png", {}), std::invalid_argument);
    EXPECT_THROW(pictures::write_curve_plots(folder / "none.png", {pictures::CurvePlot{}}), std::invalid_argument);
    EXPECT_THROW(pictures::write_curve_plots(folder / "no/such/folder.png", plots), std::runtime_error);
}

}  // namespace
}  // namespace nearpose::evaluation
