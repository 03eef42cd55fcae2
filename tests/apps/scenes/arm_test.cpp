#include "apps/scenes/arm.hpp"

#include <gtest/gtest.h>

#include "core/base/random.hpp"

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

TEST(MeasuredMotion, HandEyeErrorConjugatesTheMotion) {
    const std::vector<Pose> path = some_path(6);
    const std::vector<Pose> exact = measured_motion(path, kNone, 3);
    const std::vector<Pose> motion = measured_motion(path, {0.0, 0.0, 0.003, 0.02, 0.0}, 3);
    const Pose error = motion[0] * exact[0].inverse();
    for (std::size_t i = 1; i < path.size(); ++i) {
        const Pose true_step = exact[i] * exact[i - 1].inverse(), step = motion[i] * motion[i - 1].inverse();
        EXPECT_LT(log(step.inverse() * (error * true_step * error.inverse())).norm(), 1e-9);
        EXPECT_GT(log(step.inverse() * true_step).norm(), 1e-3);  // and is not the motion itself
    }
}

TEST(MeasuredMotion, ATimeOffsetReportsThePoseOfAnotherMoment) {
    // Constant velocity: the pose of any moment, also beyond the ends, is known.
    const Twist per_s = (Twist() << 0.3, -0.2, 0.1, 0.05, 0.1, -0.2).finished();
    const Pose start = some_path(1)[0];
    constexpr double kFps = 20.0;
    std::vector<Pose> path;
    for (int i = 0; i < 6; ++i) path.push_back(start * exp(per_s * (i / kFps)));
    const std::vector<Pose> exact = measured_motion(path, kNone, 3, kFps);
    for (const double offset_s : {0.02, -0.07, 0.05, 0.3, -0.3}) {
        const std::vector<Pose> late = measured_motion(path, {0.0, 0.0, 0.0, 0.0, offset_s}, 3, kFps);
        for (std::size_t i = 0; i < path.size(); ++i) {
            const Pose scene_from_world = path[i].inverse() * exact[i];
            const Pose expected = start * exp(per_s * (static_cast<double>(i) / kFps + offset_s)) * scene_from_world;
            EXPECT_LT(log(late[i].inverse() * expected).norm(), 1e-9) << offset_s;
        }
    }
    const std::vector<Pose> one{start};
    EXPECT_LT(
        log(measured_motion(one, {0.0, 0.0, 0.0, 0.0, 0.1}, 3)[0].inverse() * measured_motion(one, kNone, 3)[0]).norm(),
        1e-12);
}

TEST(MeasuredMotion, RefusesNegativeErrors) {
    EXPECT_THROW(measured_motion(some_path(1), {-1e-4, 0.0, 0.0, 0.0, 0.0}, 1), std::invalid_argument);
}

}  // namespace
}  // namespace nearpose::simulate
