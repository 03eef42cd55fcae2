#include "apps/evaluation/frame_errors.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace nearpose::evaluation {
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
    const PoseErrors error = pose_error(perturb_about(some_pose(), turn, centre), some_pose(), model);
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
    const PoseErrors error = pose_error(some_pose() * exp(motion), some_pose(), model);
    EXPECT_NEAR(error.rotation_rad, 0.0, 1e-6);
    EXPECT_NEAR(error.translation_m, 0.004, 1e-9);
}

}  // namespace
}  // namespace nearpose::evaluation
