#include "apps/simulate/arm.hpp"

#include <gtest/gtest.h>

#include "core/random.hpp"

namespace nearpose::simulate {
namespace {

std::vector<Pose> some_path(int count) {
    std::vector<Pose> path;
    for (int i = 0; i < count; ++i) {
        RandomStream random(7, static_cast<std::uint64_t>(i), 0, RandomPurpose::kStart);
        Pose pose;
        pose.rotation = random.rotation();
        pose.translation = random.direction();
        path.push_back(pose);
    }
    return path;
}

const ArmErrors kNone{0.0, 0.0, 0.0, 0.0, 0.0};

TEST(MeasuredMotion, WithoutErrorsTheObjectStandsStillInTheWorld) {
    const std::vector<Pose> path = some_path(20);
    const std::vector<Pose> motion = measured_motion(path, kNone, 3);
    for (std::size_t i = 0; i < path.size(); ++i) {
        const Pose world_from_object = motion[i].inverse() * path[i];
        EXPECT_LT(log((motion[0].inverse() * path[0]).inverse() * world_from_object).norm(), 1e-12);
    }
    EXPECT_GT(log(motion[0].inverse() * path[0]).norm(), 1e-3);  // and the world is not the object
}

TEST(MeasuredMotion, ErrorsHaveTheSizeAskedForAlongEveryAxis) {
    const std::vector<Pose> path = some_path(4000);
    const ArmErrors errors;
    const std::vector<Pose> exact = measured_motion(path, kNone, 3), motion = measured_motion(path, errors, 3);
    Twist sum_of_squares = Twist::Zero();
    for (std::size_t i = 0; i < path.size(); ++i) {
        sum_of_squares += log(motion[i] * exact[i].inverse()).cwiseAbs2();
    }
    const Twist sigma = (sum_of_squares / static_cast<double>(path.size())).cwiseSqrt();
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(sigma[axis] / errors.sigma_rotation_rad, 1.0, 0.06);
        EXPECT_NEAR(sigma[axis + 3] / errors.sigma_translation_m, 1.0, 0.06);
    }
}

TEST(MeasuredMotion, HandEyeErrorIsTheSameInAllFrames) {
    const std::vector<Pose> path = some_path(5);
    const ArmErrors errors{0.0, 0.0, 0.002, 0.01, 0.0};
    const std::vector<Pose> exact = measured_motion(path, kNone, 3), motion = measured_motion(path, errors, 3);
    const Twist first = log(motion[0] * exact[0].inverse());
    EXPECT_NEAR(first.head<3>().norm(), 0.01, 1e-9);
    EXPECT_NEAR(first.tail<3>().norm(), 0.002, 1e-9);
    for (std::size_t i = 1; i < path.size(); ++i) {
        EXPECT_LT((log(motion[i] * exact[i].inverse()) - first).norm(), 1e-9);
    }
}

TEST(MeasuredMotion, RefusesNegativeErrors) {
    EXPECT_THROW(measured_motion(some_path(1), {-1e-4, 0.0, 0.0, 0.0, 0.0}, 1), std::invalid_argument);
}

}  // namespace
}  // namespace nearpose::simulate
