#include "optim/setup_calibration.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "core/base/random.hpp"
#include "tests/core/world/sightings_of.hpp"

namespace nearpose {
namespace {

constexpr int kFrames = 60;

// A camera that swings about the part while it approaches, so that every unknown has an effect of its own.
Pose swinging(double frame) {
    const double t = 0.04 * frame;
    return exp(twist_of(0.25 * std::sin(t), 0.25 * std::cos(1.3 * t), 0.4 * std::sin(0.7 * t), 0.06 * std::sin(1.1 * t),
                        0.05 * std::cos(0.9 * t), -0.005 * frame));
}

struct World {
    SetupVector errors = SetupVector::Zero();
    std::uint64_t seed = 0;  // of the fits' noise; 0: none
    bool swings = true;      // else it only comes nearer, along its axis
};

// Made forwards: the true pose, what the arm gives of it, and what the fit makes of it.
std::vector<Sighting> sightings_in(const World& world) {
    RandomStream random(world.seed, 0, 0, RandomPurpose::kDiffusion);
    const auto camera_from_world = [&](double frame) {
        return world.swings ? swinging(frame) : exp(twist_of(0.0, 0.0, 0.0, 0.0, 0.0, -0.005 * frame));
    };
    const Eigen::Vector3d turn = world.errors.segment<3>(kHandEyeTurn);
    Pose given_from_camera{Eigen::Quaterniond::Identity(), world.errors.segment<3>(kHandEyeShift)};
    if (turn.norm() > 0.0) given_from_camera.rotation = Eigen::AngleAxisd(turn.norm(), turn.normalized());
    const auto given_from_world = [&](int frame) {
        return given_from_camera * camera_from_world(frame + world.errors[kTimeOffset]);
    };
    std::vector<Sighting> sightings;
    for (int frame = 0; frame < kFrames; ++frame) {
        const Pose truth = camera_from_world(frame) * kWorldFromObject;
        const JointFit fit = fit_at(truth);
        Sighting sighting;
        sighting.covariance = fit.covariance;
        sighting.setup_effect = effect_at(truth);
        Twist off = sighting.setup_effect * world.errors.head<kSetupErrors>();
        for (int i = 0; world.seed != 0 && i < 6; ++i) off[i] += random.gaussian() * std::sqrt(fit.covariance(i, i));
        sighting.camera_from_object = perturb_about(truth, off, kCentre);
        sighting.arm_from_camera = given_from_world(frame).inverse();
        sighting.camera_motion = log(given_from_world(frame - 1) * given_from_world(frame).inverse());
        sightings.push_back(sighting);
    }
    return sightings;
}

SetupVector some_errors() {
    SetupVector errors;
    errors << 0.01, 4.0, -3.0, -0.012, 0.012, -0.008, 0.01, 0.004, -0.003, 0.005, 0.4;
    return errors;
}

// The noise of the fits is independent here, and small.
SetupCalibrationOptions independent() {
    SetupCalibrationOptions options;
    options.sightings_per_error = 1.0;
    return options;
}

TEST(SetupCalibration, FindsAllErrorsTogetherWithoutNoise) {
    // Poses of another time are taken along the motion of one frame: errors as far as the motion changes.
    for (const double late_frames : {0.0, 0.4}) {
        World world;
        world.errors = some_errors();
        world.errors[kTimeOffset] = late_frames;
        SetupCalibrationOptions options = independent();
        options.prior_sigma *= 100.0;  // it pulls towards zero
        const SetupCalibration found = calibrate_setup(sightings_in(world), kCentre, options);
        ASSERT_TRUE(found.solved);
        EXPECT_EQ(found.sightings, kFrames);
        const double share = late_frames == 0.0 ? 0.002 : 0.1;
        for (Eigen::Index i = 0; i < kTimeOffset; ++i)
            EXPECT_NEAR(found.errors[i], world.errors[i], share * std::abs(world.errors[i])) << i;
        EXPECT_NEAR(found.errors[kTimeOffset], late_frames, 0.02);
        EXPECT_LT(found.unit_sigma, late_frames == 0.0 ? 1e-3 : 0.2);
    }
}

TEST(SetupCalibration, AGoodSetUpIsFoundGood) {
    const SetupCalibration found = calibrate_setup(sightings_in({}), kCentre, independent());
    ASSERT_TRUE(found.solved);
    EXPECT_LT(found.errors.norm(), 1e-6);
}

// Of 90 % intervals, over unknowns and seeds.
TEST(SetupCalibration, IntervalsHoldTheTruthAsOftenAsTheySay) {
    constexpr int kSeeds = 40;
    Eigen::Array<int, kSetupUnknowns, 1> inside = Eigen::Array<int, kSetupUnknowns, 1>::Zero();
    double unit_sigma = 0.0;
    for (int seed = 1; seed <= kSeeds; ++seed) {
        World world;
        world.errors = some_errors();
        world.seed = static_cast<std::uint64_t>(seed);
        const SetupCalibration found = calibrate_setup(sightings_in(world), kCentre, independent());
        ASSERT_TRUE(found.solved);
        unit_sigma += found.unit_sigma / kSeeds;
        for (Eigen::Index i = 0; i < kSetupUnknowns; ++i)
            inside[i] += std::abs(found.errors[i] - world.errors[i]) < 1.645 * std::sqrt(found.covariance(i, i));
    }
    EXPECT_NEAR(inside.sum() / (kSeeds * static_cast<double>(kSetupUnknowns)), 0.90, 0.05);
    EXPECT_GE(inside.minCoeff(), kSeeds * 3 / 4);
    EXPECT_NEAR(unit_sigma, 1.0, 0.1);
}

TEST(SetupCalibration, WhatTheMotionDoesNotShowKeepsThePriorsSigma) {
    World world;
    world.swings = false;
    world.seed = 1;
    const SetupCalibrationOptions options = independent();
    const SetupCalibration found = calibrate_setup(sightings_in(world), kCentre, options);
    ASSERT_TRUE(found.solved);
    // Without a turn the hand-eye shift moves the part as a whole.
    for (Eigen::Index i = kHandEyeShift; i < kHandEyeShift + 3; ++i) {
        EXPECT_GT(std::sqrt(found.covariance(i, i)), 0.9 * options.prior_sigma[i]) << i;
        EXPECT_LE(std::sqrt(found.covariance(i, i)), options.prior_sigma[i] * (1.0 + 1e-9)) << i;
    }
}

TEST(SetupCalibration, SomeWrongSightingsAreHeldDown) {
    World world;
    world.errors = some_errors();
    world.seed = 2;
    std::vector<Sighting> sightings = sightings_in(world);
    for (const int k : {5, 20, 33, 47}) sightings[k].camera_from_object.translation += Eigen::Vector3d(0.0, 0.03, 0.0);
    const SetupCalibration found = calibrate_setup(sightings, kCentre, independent());
    ASSERT_TRUE(found.solved);
    for (Eigen::Index i = 0; i < kSetupUnknowns; ++i)
        EXPECT_NEAR(found.errors[i], world.errors[i], 5.0 * std::sqrt(found.covariance(i, i))) << i;
}

TEST(SetupCalibration, ScatterBeyondTheCovariancesWidensThem) {
    World world;
    world.seed = 3;
    std::vector<Sighting> sightings = sightings_in(world);
    const SetupCalibration as_said = calibrate_setup(sightings, kCentre, independent());
    for (Sighting& sighting : sightings) sighting.covariance *= 0.04;  // sigmas a fifth of what they should be
    const SetupCalibration too_sure = calibrate_setup(sightings, kCentre, independent());
    EXPECT_GT(too_sure.unit_sigma, 3.0);
    EXPECT_GT(too_sure.covariance(kTimeOffset, kTimeOffset), 0.5 * as_said.covariance(kTimeOffset, kTimeOffset));
}

TEST(SetupCalibration, OnlyTheLongestModeCountsAndTooFewAreSaid) {
    std::vector<Sighting> sightings = sightings_in({});
    for (int k = 0; k < 20; ++k)
        sightings[k].camera_from_object.rotation =
            sightings[k].camera_from_object.rotation * Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0);
    sightings[20].other_mode = true;
    const SetupCalibration found = calibrate_setup(sightings, kCentre, independent());
    EXPECT_EQ(found.sightings, kFrames - 20);
    EXPECT_LT(found.errors.norm(), 1e-6);
    for (int k = 0; k < kFrames; k += 5) sightings[k].other_mode = true;
    const SetupCalibration few = calibrate_setup(sightings, kCentre, independent());
    EXPECT_FALSE(few.solved);
    EXPECT_EQ(few.errors, SetupVector::Zero());
    EXPECT_EQ(SetupVector(few.covariance.diagonal().cwiseSqrt()), independent().prior_sigma);
}

TEST(SetupCalibration, OptionsOutOfBoundsAreNamed) {
    SetupCalibrationOptions options;
    options.prior_sigma[kTimeOffset] = 0.0;
    try {
        calibrate_setup({}, kCentre, options);
        FAIL();
    } catch (const std::invalid_argument& error) {
        EXPECT_NE(std::string(error.what()).find("prior_sigma"), std::string::npos) << error.what();
    }
}

}  // namespace
}  // namespace nearpose
