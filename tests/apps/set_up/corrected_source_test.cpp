#include "apps/set_up/corrected_source.hpp"

#include <gtest/gtest.h>

#include <memory>

namespace nearpose::program {
namespace {

Pose at(double time_s) {
    Twist twist;
    twist << 0.3 * time_s, -0.2 * time_s, 0.1 * time_s, 0.5 * time_s, 0.0, -time_s;
    return exp(twist);
}

// A camera that goes on by one motion; its poses are given for `late_s` after each image.
class MovingSource : public FrameSource {
  public:
    MovingSource(double late_s, const Pose& given_from_camera) {
        scene_id_ = 7;
        for (int k = 0; k < 10; ++k) {
            const double stamp_s = k * k * 0.01;  // uneven
            frames_.push_back({k, stamp_s, {4, 3, 600.0, 600.0, 2.0, 1.0}, given_from_camera * at(stamp_s + late_s)});
        }
    }
    FrameData load(std::size_t index) const override {
        FrameData data;
        data.depth = {4, 3, std::vector<float>(12, 0.5F)};
        data.depth.depth_m[0] = 0.0F;
        data.points_in_camera = {{0.0F, 0.1F, 0.02F * static_cast<float>(index)}};
        return data;
    }
    void stop_clock() {
        for (FrameInfo& frame : frames_) frame.stamp_s = 0.0;
    }
    void lose_pose(std::size_t index) { frames_[index].camera_from_world.reset(); }
};

TEST(CorrectedSource, PosesAreThoseOfTheCameraAtItsImages) {
    Pose given_from_camera = at(0.07);
    given_from_camera.translation *= 0.1;
    auto given = std::make_shared<MovingSource>(0.013, given_from_camera);
    given->lose_pose(4);
    SetupErrors errors;
    errors.given_from_camera = given_from_camera;
    errors.time_offset_s = 0.013;
    const auto right = corrected_source(given, errors);
    ASSERT_EQ(right->frames().size(), 10U);
    EXPECT_EQ(right->scene_id(), 7);
    for (int k = 0; k < 10; ++k) {
        const std::optional<Pose>& pose = right->frames()[k].camera_from_world;
        ASSERT_EQ(pose.has_value(), k != 4);
        if (!pose) continue;
        EXPECT_LT(log(pose->inverse() * at(k * k * 0.01)).norm(), 1e-9) << k;
    }
}

TEST(CorrectedSource, WithoutTimesPosesKeepTheirs) {
    auto given = std::make_shared<MovingSource>(0.0, Pose::identity());
    given->stop_clock();
    SetupErrors errors;
    errors.time_offset_s = 0.02;
    const auto right = corrected_source(given, errors);
    for (int k = 0; k < 10; ++k)
        EXPECT_EQ(right->frames()[k].camera_from_world->translation, given->frames()[k].camera_from_world->translation);
    EXPECT_EQ(usual_step_s(*given), 0.0);
}

TEST(CorrectedSource, DepthsAndPointsAreScaledAndHolesStay) {
    SetupErrors errors;
    errors.depth_scale = 0.25;
    errors.focal_length = 0.2;
    const auto right = corrected_source(std::make_shared<MovingSource>(0.0, Pose::identity()), errors);
    const FrameData data = right->load(5);
    EXPECT_EQ(data.depth.depth_m[0], 0.0F);
    EXPECT_FLOAT_EQ(data.depth.depth_m[1], 0.4F);
    EXPECT_FLOAT_EQ(data.points_in_camera[0].z(), 0.08F);
    EXPECT_NEAR(right->frames()[0].camera.fx, 500.0, 1e-9);
}

TEST(CorrectedSource, TheUsualStepIsTheMedian) {
    EXPECT_NEAR(usual_step_s(MovingSource(0.0, Pose::identity())), 0.09, 1e-12);  // of 0.01, 0.03, ... 0.17
}

}  // namespace
}  // namespace nearpose::program
