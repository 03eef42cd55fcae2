#include "apps/pose_error.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <numbers>

#include "apps/frame_log.hpp"
#include "apps/pictures/axis.hpp"
#include "core/random.hpp"

namespace nearpose::program {
namespace {

data_set::ModelInfo unit_model() {
    data_set::ModelInfo model;
    model.box_min_in_object_m = {-0.1, -0.1, 0.0};
    model.box_max_in_object_m = {0.1, 0.1, 0.3};
    return model;
}

Pose some_pose() {
    Twist twist;
    twist << 0.3, -0.7, 1.1, 0.02, -0.05, 0.6;
    return exp(twist);
}

TEST(PoseError, IsMeasuredAtTheCentreOfTheBox) {
    const data_set::ModelInfo model = unit_model();
    Twist turn = Twist::Zero();
    turn[0] = 0.02;
    const Eigen::Vector3d centre(0.0, 0.0, 0.15);
    const PoseError error = pose_error(perturb_about(some_pose(), turn, centre), some_pose(), model);
    EXPECT_NEAR(error.translation_m, 0.0, 1e-12);
    EXPECT_NEAR(error.rotation_rad, 0.02, 1e-9);
}

TEST(PoseError, DiscreteSymmetriesAreForgiven) {
    data_set::ModelInfo model = unit_model();
    const Eigen::AngleAxisd half_turn(std::numbers::pi, Eigen::Vector3d::UnitZ());
    const Pose turned{Eigen::Quaterniond(half_turn), Eigen::Vector3d::Zero()};
    EXPECT_NEAR(pose_error(some_pose() * turned, some_pose(), model).rotation_rad, std::numbers::pi, 1e-9);
    model.discrete_symmetries = {turned};
    EXPECT_NEAR(pose_error(some_pose() * turned, some_pose(), model).rotation_rad, 0.0, 1e-9);
}

TEST(PoseError, ContinuousSymmetriesAreSearchedToTheBottom) {
    data_set::ModelInfo model = unit_model();
    model.continuous_symmetries = {{Eigen::Vector3d::UnitZ(), Eigen::Vector3d::Zero()}};
    Twist motion = Twist::Zero();
    motion[2] = 1.2345;  // about the axis: no error
    motion[5] = 0.004;   // along it
    const PoseError error = pose_error(some_pose() * exp(motion), some_pose(), model);
    EXPECT_NEAR(error.rotation_rad, 0.0, 1e-6);
    EXPECT_NEAR(error.translation_m, 0.004, 1e-9);
}

TEST(PoseError, StatisticsOfKnownValues) {
    const ErrorStatistics statistics = statistics_of({5.0, 1.0, 2.0, 4.0, 3.0});
    EXPECT_DOUBLE_EQ(statistics.mean, 3.0);
    EXPECT_DOUBLE_EQ(statistics.median, 3.0);
    EXPECT_DOUBLE_EQ(statistics.percentile_95, 4.8);
    EXPECT_DOUBLE_EQ(statistics.max, 5.0);
}

TEST(PoseError, ArrivalAndHolding) {
    const ErrorLimit limit{0.01, 0.1};
    const FrameError good{0, PoseError{0.001, 0.01}}, bad{0, PoseError{0.1, 0.01}}, lost{0, std::nullopt};
    const auto frames = [](std::vector<FrameError> list) {
        for (std::size_t i = 0; i < list.size(); ++i) list[i].frame_id = static_cast<int>(i);
        return list;
    };
    EXPECT_EQ(arrives_at(frames({bad, good, lost, good}), limit), 1);
    EXPECT_EQ(holds_from(frames({bad, good, lost, good}), limit), 3);
    EXPECT_EQ(holds_from(frames({good, good, lost}), limit), std::nullopt);
    EXPECT_EQ(arrives_at(frames({bad, lost}), limit), std::nullopt);
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

namespace nearpose::pictures {
namespace {

TEST(Axis, HoldsItsValuesAndTicks) {
    for (const std::vector<double>& values :
         {std::vector<double>{0.0}, {0.3, 0.4}, {0.012, 7.0}, {1e-5, 300.0}, {0.0, 5.0, 1000.0}, {4.99}}) {
        const Axis axis = error_axis(values);
        ASSERT_LT(axis.low, axis.high);
        ASSERT_GE(axis.ticks.size(), 2U);
        for (const double tick : axis.ticks) {
            EXPECT_GE(tick, axis.low * 0.999);
            EXPECT_LE(tick, axis.high * 1.001);
        }
        EXPECT_LE(*std::max_element(values.begin(), values.end()), axis.high);
        EXPECT_DOUBLE_EQ(axis.fraction(axis.low), 0.0);
        EXPECT_DOUBLE_EQ(axis.fraction(axis.high), 1.0);
    }
    EXPECT_EQ(Axis::label(0.05), "0.05");
    EXPECT_EQ(Axis::label(0.002), "0.002");
    EXPECT_EQ(Axis::label(20.0), "20");
    EXPECT_EQ(Axis::label(0.0), "0");
    EXPECT_EQ(Axis::label(1.5), "1.5");
    EXPECT_EQ(Axis::label(3 * 0.1), "0.3");
}

}  // namespace
}  // namespace nearpose::pictures
