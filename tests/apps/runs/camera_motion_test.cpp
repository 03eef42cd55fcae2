#include "apps/runs/camera_motion.hpp"

#include <gtest/gtest.h>

namespace nearpose::program {
namespace {

Twist twist_of(double rx, double ry, double rz, double x, double y, double z) {
    Twist twist;
    twist << rx, ry, rz, x, y, z;
    return twist;
}

// The camera goes on by the same motion from frame to frame; frame 2 lacks its pose.
const Twist kMotion = twist_of(0.01, -0.02, 0.005, 0.004, 0.0, 0.01);
std::vector<FrameInfo> frames() {
    std::vector<FrameInfo> list(5);
    const Pose first = exp(twist_of(0.4, 2.0, -0.3, 0.1, 0.2, 0.9));
    for (int k = 0; k < 5; ++k) list[k].camera_from_world = (first * exp(Twist(k * kMotion))).inverse();
    list[2].camera_from_world.reset();
    return list;
}

UpdateResult seen() {
    UpdateResult result;
    result.status = UpdateStatus::kEstimated;
    result.camera_from_object = exp(twist_of(0.3, -0.7, 1.1, 0.02, -0.05, 0.6));
    result.covariance = 1e-8 * Matrix6d::Identity();
    return result;
}

TEST(CameraMotion, TheControlIsThatFromTheFrameBefore) {
    const std::vector<FrameInfo> list = frames();
    EXPECT_FALSE(control_of(list, 0));
    EXPECT_FALSE(control_of(list, 2));
    EXPECT_FALSE(control_of(list, 3)) << "nothing to start from";
    const std::optional<Pose> control = control_of(list, 4);
    ASSERT_TRUE(control);
    EXPECT_LT((log(control->inverse()) - kMotion).norm(), 1e-12);
}

TEST(CameraMotion, ThePlaceNeedsThePosesOfPartAndCamera) {
    EXPECT_FALSE(place_of(frames(), 2, seen()));
    EXPECT_FALSE(place_of(frames(), 1, UpdateResult{}));
    const std::optional<PlaceInWorld> place = place_of(frames(), 1, seen());
    ASSERT_TRUE(place);
    const Pose back = *frames()[1].camera_from_world * place->world_from_object;
    EXPECT_LT(log(back.inverse() * seen().camera_from_object).norm(), 1e-12);
}

// The motion counts in the camera's axes, forwards in time: the place of a late arm lies along it.
TEST(CameraMotion, ThePlaceAllowsForAnArmThatIsLate) {
    ArmCheckOptions setup;
    setup.still_world.usual = {};
    setup.still_world.usual.time_offset_frames = 0.1;
    setup.sightings.arm_rotation_rad = setup.sightings.arm_translation_m = 0.0;
    const PlaceInWorld place = *place_of(frames(), 4, seen(), setup);
    const Pose world_from_late = frames()[4].camera_from_world->inverse() * exp(Twist(-0.1 * kMotion));
    const Twist off = log(place.world_from_object.inverse() * world_from_late * seen().camera_from_object);
    EXPECT_LT((place.covariance - seen().covariance - off * off.transpose()).norm(), 1e-9 * place.covariance.norm());
    EXPECT_EQ(place_of(frames(), 3, seen(), setup)->covariance, seen().covariance) << "as if at rest";
}

}  // namespace
}  // namespace nearpose::program
