#include "core/world/sighting.hpp"

#include <gtest/gtest.h>

#include "tests/core/world/sightings_of.hpp"

namespace nearpose {
namespace {

Pose as_given(const Pose& motion) {
    return motion;
}

JointFit of_a_part_that_stands(int frame) {
    return fit_at(approach(frame) * kWorldFromObject);
}

TEST(Sightings, APartThatStandsStaysWhereItIsByTheArm) {
    const Sightings sightings = sightings_of(20, of_a_part_that_stands, as_given);
    ASSERT_EQ(sightings.kept.size(), 20U);
    const Pose first = sightings.kept[0].arm_from_object();
    for (const Sighting& sighting : sightings.kept)
        EXPECT_LT(twist_about(first, sighting.arm_from_object(), kCentre).norm(), 1e-12);
}

TEST(Sightings, TheWindowSlides) {
    SightingOptions options;
    options.max_count = 7;
    Sightings sightings;
    for (int frame = 0; frame < 20; ++frame) {
        if (frame > 0) sightings = after_motion(sightings, approach(frame) * approach(frame - 1).inverse());
        sightings = with_sighting(sightings, of_a_part_that_stands(frame), Continuity::kAsPredicted, kCentre, options);
    }
    ASSERT_EQ(sightings.kept.size(), 7U);
    EXPECT_LT(twist_about(sightings.kept.back().camera_from_object, approach(19) * kWorldFromObject, kCentre).norm(),
              1e-12);
}

TEST(Sightings, ACameraAtRestAddsNone) {
    Sightings sightings;
    for (int frame = 0; frame < 20; ++frame) {
        if (frame > 0) sightings = after_motion(sightings, Pose{});
        sightings = with_sighting(sightings, of_a_part_that_stands(0), Continuity::kAsPredicted, kCentre, {});
    }
    EXPECT_EQ(sightings.kept.size(), 2U);
}

TEST(Sightings, WithoutAMeasuredMotionNothingHoldsThatWasSeen) {
    const Sightings sightings = sightings_of(5, of_a_part_that_stands, as_given);
    EXPECT_TRUE(after_motion(sightings, std::nullopt).kept.empty());
}

TEST(Sightings, APushIsAMoveAndAConveyorOnlyInItsFirstFrame) {
    const auto moved = [](double push_m, double step_m) {
        std::vector<bool> flags;
        Sightings sightings;
        for (int frame = 0; frame < 8; ++frame) {
            if (frame > 0) sightings = after_motion(sightings, approach(frame) * approach(frame - 1).inverse());
            Pose world_from_object = kWorldFromObject;
            if (frame >= 4) {
                const double steps = frame - 3;
                world_from_object =
                    perturb_about(world_from_object, twist_of(0, 0, 8.0 * steps * step_m, 0, 0, 0), kCentre);
                world_from_object.translation.x() += push_m + step_m * steps;
            }
            const bool contradicted = frame == 4 || (frame > 4 && step_m > 0.0);
            sightings = with_sighting(sightings, fit_at(approach(frame) * world_from_object),
                                      contradicted ? Continuity::kContradicted : Continuity::kAsPredicted, kCentre, {});
            flags.push_back(sightings.kept.back().moved);
        }
        return flags;
    };
    const std::vector<bool> once = {false, false, false, false, true, false, false, false};
    EXPECT_EQ(moved(0.02, 0.0), once);
    EXPECT_EQ(moved(0.0, 0.005), once);
}

TEST(Sightings, AnotherModeCountsAsAMoveOnceAPoseWasAccepted) {
    const auto with = [](const Sightings& before, Continuity continuity) {
        return with_sighting(before, fit_at(kWorldFromObject), continuity, kCentre, {});
    };
    Sightings sightings = with(with({}, Continuity::kOtherMode), Continuity::kOtherMode);
    EXPECT_FALSE(sightings.frames_since_move.has_value());
    sightings = with(sightings, Continuity::kOtherThanAccepted);
    EXPECT_EQ(sightings.frames_since_move, 0);
    sightings = with(with(sightings, Continuity::kAsPredicted), Continuity::kOtherMode);
    EXPECT_EQ(sightings.frames_since_move, 0);
}

TEST(Sightings, FramesAreCountedSinceAMoveAlsoWhileTheCameraRests) {
    Sightings sightings;
    for (int frame = 0; frame < 10; ++frame) {
        if (frame > 0) sightings = after_motion(sightings, Pose{});
        Pose world_from_object = kWorldFromObject;
        if (frame >= 4) world_from_object.translation.x() += 0.02;
        sightings = with_sighting(sightings, fit_at(world_from_object),
                                  frame == 4 ? Continuity::kContradicted : Continuity::kAsPredicted, kCentre, {});
        const int since_move = sightings.frames_since_move.value_or(-1);
        EXPECT_EQ(since_move, frame < 4 ? -1 : frame - 4);
    }
}

}  // namespace
}  // namespace nearpose
