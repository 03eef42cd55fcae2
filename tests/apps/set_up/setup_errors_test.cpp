#include "apps/set_up/setup_errors.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace nearpose::program {
namespace {

SetupVector some_errors() {
    SetupVector errors;
    errors << 0.02, 3.0, -2.0, 0.01, 0.02, -0.01, 0.03, 0.004, 0.001, -0.002, 0.5;
    return errors;
}

TEST(SetupErrors, GoToTheUnknownsAndBack) {
    const SetupErrors errors = errors_of(some_errors(), 0.1);
    EXPECT_DOUBLE_EQ(errors.time_offset_s, 0.05);
    EXPECT_LT((in_order(errors, 0.1) - some_errors()).norm(), 1e-12);
    EXPECT_EQ(in_order(SetupErrors{}, 0.1), SetupVector::Zero());
}

// What is corrected twice is corrected by both.
TEST(SetupErrors, ComposeAsCorrectionsDo) {
    const SetupErrors first = errors_of(some_errors(), 0.1);
    const SetupErrors left = errors_of(-0.3 * some_errors().reverse().eval(), 0.1);
    const SetupErrors both = composed(first, left);
    const PinholeCamera given{640, 480, 600.0, 610.0, 320.0, 240.0};
    const PinholeCamera once = corrected(given, both), twice = corrected(corrected(given, first), left);
    EXPECT_NEAR(once.fx, twice.fx, 1e-9);
    EXPECT_NEAR(once.fy, twice.fy, 1e-9);
    EXPECT_NEAR(once.cx, twice.cx, 1e-9);
    EXPECT_NEAR(once.cy, twice.cy, 1e-9);
    Twist twist;
    twist << 0.3, -0.5, 0.2, 0.1, 0.4, 0.7;
    const Pose pose = exp(twist);
    EXPECT_LT(log(corrected(pose, both).inverse() * corrected(corrected(pose, first), left)).norm(), 1e-12);
}

TEST(SetupErrors, WhatIsGivenIsTooLargeByThem) {
    SetupErrors errors;
    errors.focal_length = 0.02;
    errors.principal_point_pixels = {4.0, -1.0};
    const PinholeCamera right = corrected({640, 480, 612.0, 612.0, 324.0, 239.0}, errors);
    EXPECT_NEAR(right.fx, 600.0, 1e-9);
    EXPECT_NEAR(right.fy, 600.0, 1e-9);
    EXPECT_NEAR(right.cx, 320.0, 1e-9);
    EXPECT_NEAR(right.cy, 240.0, 1e-9);
}

TEST(SetupErrors, OnlyWhatMayBeAtFaultHasAWidePrior) {
    const SetupVector wide = in_order(StillWorldOptions{}.faulty), usual = in_order(StillWorldOptions{}.usual);
    EXPECT_EQ(prior_with_unknown(setup_parts()), wide);
    EXPECT_EQ(prior_with_unknown({}), usual);
    const SetupVector hand_eye = prior_with_unknown({"hand-eye"});
    for (Eigen::Index i = 0; i < kSetupUnknowns; ++i) {
        const bool is_wide = i >= kHandEyeTurn && i < kTimeOffset;
        EXPECT_EQ(hand_eye[i], is_wide ? wide[i] : usual[i]) << i;
    }
    EXPECT_THROW(prior_with_unknown({"lens"}), std::invalid_argument);
    SetupVector time = SetupVector::Zero();
    time[kTimeOffset] = some_errors()[kTimeOffset];
    EXPECT_EQ(only_of({"time"}, some_errors()), time);
}

}  // namespace
}  // namespace nearpose::program
