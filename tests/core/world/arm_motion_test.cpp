#include "core/world/arm_motion.hpp"

#include <gtest/gtest.h>

#include <functional>

#include "tests/core/world/sightings_of.hpp"

namespace nearpose {
namespace {

constexpr double kRadius_m = 0.1;
constexpr double kHalfTurn_rad = 3.14159265358979323846;

Pose turn_about_z(double angle_rad) {
    return {Eigen::Quaterniond(Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::UnitZ())), Eigen::Vector3d::Zero()};
}

ArmMotion motion_of(const std::function<Pose(const Pose&)>& given) {
    const auto seen = [](int frame) { return fit_at(approach(frame) * kWorldFromObject); };
    return compare_motions(sightings_of(12, seen, given).kept, kCentre, kRadius_m);
}

TEST(ArmMotion, AnArmThatIsRightIsNotOff) {
    const ArmMotion motion = motion_of([](const Pose& m) { return m; });
    EXPECT_EQ(motion.pairs, 8);
    EXPECT_LT(motion.off_share, 1e-9);
    EXPECT_EQ(motion.mistake, MotionMistake::kNone);
}

// The given motion of a usual mistake, and its name.
TEST(ArmMotion, TheUsualMistakesAreNamed) {
    struct Case {
        MotionMistake mistake;
        std::function<Pose(const Pose&)> given;
    };
    const auto turned = [](double angle_rad) {
        return [=](const Pose& m) { return turn_about_z(-angle_rad) * m * turn_about_z(angle_rad); };
    };
    const auto mirrored = [](int axis) {
        return [=](const Pose& m) {
            Eigen::Matrix3d mirror = Eigen::Matrix3d::Identity();
            mirror(axis, axis) = -1.0;
            return Pose::from_matrix(mirror * m.rotation_matrix() * mirror, mirror * m.translation);
        };
    };
    const auto scaled = [](double factor) {
        return [=](const Pose& m) { return Pose{m.rotation, factor * m.translation}; };
    };
    const Pose hand_eye = exp(twist_of(0.8, -0.4, 0.3, 0, 0, 0));
    const std::vector<Case> cases = {
        {MotionMistake::kInverted, [](const Pose& m) { return m.inverse(); }},
        {MotionMistake::kTurned90, turned(0.5 * kHalfTurn_rad)},
        {MotionMistake::kTurned180, turned(kHalfTurn_rad)},
        {MotionMistake::kTurned270, turned(1.5 * kHalfTurn_rad)},
        {MotionMistake::kMirrored, mirrored(0)},
        {MotionMistake::kFlipped, mirrored(1)},
        {MotionMistake::kMillimetres, scaled(1e3)},
        {MotionMistake::kMetres, scaled(1e-3)},
        {MotionMistake::kTurned, [&](const Pose& m) { return hand_eye.inverse() * m * hand_eye; }},
    };
    for (const Case& usual : cases) {
        const ArmMotion motion = motion_of(usual.given);
        EXPECT_STREQ(to_string(motion.mistake), to_string(usual.mistake));
        EXPECT_GT(motion.off_share, 0.3);
    }
}

TEST(ArmMotion, APartThatMovesByItselfIsNoMistakeOfTheArm) {
    const auto seen = [](int frame) {
        Pose world_from_object = kWorldFromObject;
        world_from_object.translation.x() += 0.003 * frame;
        return fit_at(approach(frame) * world_from_object);
    };
    const ArmMotion motion =
        compare_motions(sightings_of(12, seen, [](const Pose& m) { return m; }).kept, kCentre, kRadius_m);
    EXPECT_GT(motion.off_share, 0.3);
    EXPECT_EQ(motion.mistake, MotionMistake::kNone);
}

TEST(ArmMotion, AChangeOfTheModeIsNoMotionAndForgetsNone) {
    const auto seen = [](int frame) {
        const Pose other = frame < 8 ? Pose{} : turn_about_z(2.0);
        return fit_at(approach(frame) * kWorldFromObject * other);
    };
    std::vector<Sighting> kept = sightings_of(10, seen, [](const Pose& m) { return m.inverse(); }).kept;
    kept[8].other_mode = true;
    const ArmMotion motion = compare_motions(kept, kCentre, kRadius_m);
    EXPECT_EQ(motion.pairs, 8) << "of nine";
    EXPECT_EQ(motion.mistake, MotionMistake::kInverted);
}

TEST(ArmMotion, FewPairsOrNoMotionTellNothing) {
    const auto rest = [](int) { return fit_at(kWorldFromObject); };
    const Sightings still = sightings_of(12, rest, [](const Pose& m) { return m.inverse(); });
    EXPECT_EQ(compare_motions(still.kept, kCentre, kRadius_m).pairs, 0);
    const auto seen = [](int frame) { return fit_at(approach(frame) * kWorldFromObject); };
    const Sightings few = sightings_of(3, seen, [](const Pose& m) { return m.inverse(); });
    EXPECT_EQ(compare_motions(few.kept, kCentre, kRadius_m).mistake, MotionMistake::kNone);
}

}  // namespace
}  // namespace nearpose
