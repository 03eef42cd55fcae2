#include "apps/estimate/frame_log.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "apps/data_set/json_file.hpp"
#include "core/base/random.hpp"

namespace nearpose::program {
namespace {

Pose some_pose() {
    Twist twist;
    twist << 0.3, -0.7, 1.1, 0.02, -0.05, 0.6;
    return exp(twist);
}

TEST(FirstLogLine, StatesTheToleranceOfTheVerdicts) {
    RunDescription run;
    run.tolerance = {0.005, 0.02};
    const auto file = data_set::JsonFile::from_text(first_log_line(run), "log");
    EXPECT_DOUBLE_EQ(file.root().at("tolerance_m").number(), 0.005);
    EXPECT_DOUBLE_EQ(file.root().at("tolerance_rad").number(), 0.02);
}

TEST(FirstLogLine, StatesTheErrorsThatTheCovarianceInTheWorldAllowsFor) {
    const auto file = data_set::JsonFile::from_text(first_log_line({}), "log");
    const data_set::JsonValue sigmas = file.root().at("world_sigmas");
    EXPECT_DOUBLE_EQ(sigmas.at("hand_eye_m").number(), StillWorldOptions{}.usual.hand_eye_m);
    EXPECT_DOUBLE_EQ(sigmas.at("arm_rotation_rad").number(), SightingOptions{}.arm_rotation_rad);
}

TEST(FrameLogLine, HoldsThePartInTheWorldWhereTheCamerasPoseIsKnown) {
    UpdateResult result;
    result.status = UpdateStatus::kEstimated;
    FrameReport frame{3, 0.1, 0.01, {}, {}};
    const auto without = data_set::JsonFile::from_text(frame_log_line(frame, result), "log");
    EXPECT_FALSE(without.root().find("world_from_object"));

    PlaceInWorld place{some_pose(), Matrix6d::Identity()};
    place.covariance(0, 4) = place.covariance(4, 0) = 0.5;
    frame.in_world = place;
    const auto file = data_set::JsonFile::from_text(frame_log_line(frame, result), "log");
    const data_set::JsonValue world = file.root().at("world_from_object");
    for (int i = 0; i < 3; ++i)
        EXPECT_EQ(world.at("translation_m").numbers(3)[i], place.world_from_object.translation[i]);
    for (int i = 0; i < 4; ++i)
        EXPECT_EQ(world.at("quaternion_xyzw").numbers(4)[i], place.world_from_object.rotation.coeffs()[i]);
    const Matrix6d ros = ros_covariance(place.covariance, place.world_from_object);
    for (int i = 0; i < 36; ++i) {
        EXPECT_EQ(world.at("covariance").numbers(36)[i], place.covariance(i / 6, i % 6));
        EXPECT_EQ(world.at("covariance_ros").numbers(36)[i], ros(i / 6, i % 6));
    }
}

// Poses drawn from the right perturbation scatter about the camera's axes as covariance_ros says.
TEST(RosCovariance, IsThatOfSampledPoses) {
    Twist sigmas;
    sigmas << 0.002, 0.004, 0.001, 0.003, 0.001, 0.0005;
    Matrix6d factor = sigmas.asDiagonal();
    factor(3, 1) = 0.002;  // translation and rotation depend on each other
    const Matrix6d covariance = factor * factor.transpose();
    const Pose pose = some_pose();
    RandomStream random(3, 0, 0, RandomPurpose::kStart);
    constexpr int kDraws = 40000;
    Matrix6d sampled = Matrix6d::Zero();
    for (int i = 0; i < kDraws; ++i) {
        Twist draw;
        for (int k = 0; k < 6; ++k) draw[k] = random.gaussian();
        const Pose moved = pose * exp(Twist(factor * draw));
        Twist in_camera;
        in_camera << moved.translation - pose.translation,
            log(Pose{moved.rotation * pose.rotation.conjugate(), Eigen::Vector3d::Zero()}).head<3>();
        sampled += in_camera * in_camera.transpose() / kDraws;
    }
    const Matrix6d expected = ros_covariance(covariance, pose);
    EXPECT_LT((sampled - expected).norm(), 0.03 * expected.norm());
}

}  // namespace
}  // namespace nearpose::program
