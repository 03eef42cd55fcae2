#include "apps/calibrate/setup_table.hpp"

#include <gtest/gtest.h>

#include "tests/apps/support/contains.hpp"
#include "tests/apps/support/tiny_scene.hpp"

namespace nearpose::program {
namespace {

using program_tests::lines_of;

const PinholeCamera kGiven{640, 480, 606.0, 606.0, 324.5, 239.5};

Calibration with_error(Eigen::Index unknown, double error) {
    SetupVector errors = SetupVector::Zero();
    errors[unknown] = error;
    Calibration calibration;
    calibration.frame_s = 0.1;
    calibration.prior_sigma = prior_with_unknown(setup_parts());
    calibration.sigma = 0.1 * calibration.prior_sigma;
    calibration.errors = errors_of(errors, calibration.frame_s);
    calibration.estimate = errors;
    calibration.unknown = setup_parts();
    return calibration;
}

TEST(SetupTable, AFindingFollowsFromErrorAndSigmas) {
    EXPECT_EQ(finding_of(0.0, 0.1, 1.0), SetupFinding::kAsGiven);
    EXPECT_EQ(finding_of(0.29, 0.1, 1.0), SetupFinding::kAsGiven);
    EXPECT_EQ(finding_of(-0.31, 0.1, 1.0), SetupFinding::kContradicted);
    EXPECT_EQ(finding_of(0.1, 0.9, 1.0), SetupFinding::kNotShown);
    EXPECT_EQ(finding_of(3.0, 0.9, 1.0), SetupFinding::kContradicted);
}

TEST(SetupTable, HasARowForEachUnknownInItsUnit) {
    const std::vector<std::string> lines = lines_of(setup_table(with_error(kHandEyeShift + 1, 0.0075)));
    ASSERT_EQ(lines.size(), 1U + kSetupUnknowns);
    EXPECT_TRUE(contains(lines[1 + kHandEyeShift + 1], "hand-eye shift along y [mm]"));
    EXPECT_TRUE(contains(lines[1 + kHandEyeShift + 1], "7.50"));
    EXPECT_TRUE(contains(lines[1 + kHandEyeShift + 1], "contradicted"));
    EXPECT_TRUE(contains(lines[1], "as given"));
    EXPECT_TRUE(contains(lines[1 + kTimeOffset], "20.00")) << "0.2 frames of 100 ms: " << lines[1 + kTimeOffset];
}

TEST(SetupTable, AdviceSaysWhatToWriteInstead) {
    EXPECT_EQ(advice_of(with_error(kTimeOffset, 0.0), kGiven), "nothing to change\n");
    EXPECT_TRUE(contains(advice_of(with_error(kFocalLengthError, 0.01), kGiven), "fx = 600.00"));
    EXPECT_TRUE(contains(advice_of(with_error(kImageColumns, 4.5), kGiven), "cx = 320.00, cy = 239.50"));
    EXPECT_TRUE(contains(advice_of(with_error(kDepthScaleError, 0.25), kGiven), "depth_scale by 0.80000"));
    EXPECT_TRUE(contains(advice_of(with_error(kTimeOffset, 1.5), kGiven), "150.0 ms earlier"));
    EXPECT_TRUE(contains(advice_of(with_error(kTimeOffset, -1.5), kGiven), "150.0 ms later"));
    // What may not be at fault is not advised on, but named.
    Calibration other = with_error(kTimeOffset, 1.5);
    other.unknown = {"focal"};
    other.errors = {};
    EXPECT_FALSE(contains(advice_of(other, kGiven), "clocks"));
    EXPECT_TRUE(contains(advice_of(other, kGiven), "contradicts time too"));
    // The right pose is the inverse of the error times the given one.
    EXPECT_TRUE(contains(advice_of(with_error(kHandEyeShift, 0.005), kGiven), "-5.000"));
}

}  // namespace
}  // namespace nearpose::program
