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
