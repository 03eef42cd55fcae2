#include "core/base/pose.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <unsupported/Eigen/MatrixFunctions>

namespace nearpose {
namespace {

Eigen::Matrix4d matrix_of(const Pose& pose) {
    Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
    matrix.topLeftCorner<3, 3>() = pose.rotation_matrix();
    matrix.topRightCorner<3, 1>() = pose.translation;
    return matrix;
}

Eigen::Matrix4d hat(const Twist& twist) {
    Eigen::Matrix4d matrix = Eigen::Matrix4d::Zero();
    const Eigen::Vector3d w = twist.head<3>();
    matrix.topLeftCorner<3, 3>() << 0, -w.z(), w.y(), w.z(), 0, -w.x(), -w.y(), w.x(), 0;
    matrix.topRightCorner<3, 1>() = twist.tail<3>();
    return matrix;
}

Twist random_twist(std::mt19937& random, double angle_rad) {
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    const Eigen::Vector3d axis = Eigen::Vector3d(uniform(random), uniform(random), uniform(random)).normalized();
    Twist twist;
    twist << angle_rad * axis, uniform(random), uniform(random), uniform(random);
    return twist;
}

// Zero, tiny, around the switch between series and closed form, ordinary, and near pi.
const double kAngles[] = {0.0, 1e-12, 1e-8, 1e-5, 0.999e-3, 1.001e-3, 0.1, 1.0, 2.0, 3.0, 3.14, M_PI - 1e-6};

TEST(Pose, ExpIsTheMatrixExponential) {
    std::mt19937 random(1);
    for (const double angle : kAngles) {
        const Twist twist = random_twist(random, angle);
        EXPECT_LT((matrix_of(exp(twist)) - hat(twist).exp()).norm(), 1e-12) << angle;
    }
}

TEST(Pose, LogUndoesExp) {
    std::mt19937 random(2);
    for (const double angle : kAngles) {
        const Twist twist = random_twist(random, angle);
        EXPECT_LT((log(exp(twist)) - twist).norm(), 1e-9) << angle;
    }
}

TEST(Pose, ExpOfLogNearPi) {
    std::mt19937 random(3);
    for (const double angle : {M_PI - 1e-9, M_PI - 1e-13, M_PI}) {
        const Pose pose = exp(random_twist(random, angle));
        const Pose again = exp(log(pose));
        EXPECT_LT((matrix_of(again) - matrix_of(pose)).norm(), 1e-8) << angle;
    }
}

TEST(Pose, PerturbationActsOnTheRightInObjectAxes) {
    const Pose camera_from_object{Eigen::Quaterniond(Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ())), {0, 0, 1}};
    Twist along_object_x = Twist::Zero();
    along_object_x[3] = 0.1;
    const Eigen::Vector3d moved = (camera_from_object * exp(along_object_x)).translation;
    EXPECT_NEAR((moved - Eigen::Vector3d(0, 0.1, 1)).norm(), 0.0, 1e-15);
}

TEST(Pose, GroupLaws) {
    std::mt19937 random(4);
    for (int k = 0; k < 20; ++k) {
        const Pose a = exp(random_twist(random, 1.0)), b = exp(random_twist(random, 2.0)),
                   c = exp(random_twist(random, 3.0));
        EXPECT_LT((matrix_of((a * b) * c) - matrix_of(a * (b * c))).norm(), 1e-13);
        EXPECT_LT((matrix_of(a * a.inverse()) - Eigen::Matrix4d::Identity()).norm(), 1e-14);
        EXPECT_LT((matrix_of(a * b) - matrix_of(a) * matrix_of(b)).norm(), 1e-14);
    }
}

TEST(Pose, InterpolationStartsEndsAndHalves) {
    std::mt19937 random(5);
    const Pose a = exp(random_twist(random, 1.0)), b = exp(random_twist(random, 0.7));
    EXPECT_LT((matrix_of(interpolate(a, b, 0.0)) - matrix_of(a)).norm(), 1e-13);
    EXPECT_LT((matrix_of(interpolate(a, b, 1.0)) - matrix_of(b)).norm(), 1e-13);
    const Pose half = interpolate(a, b, 0.5);
    EXPECT_LT((matrix_of(half * (a.inverse() * half)) - matrix_of(b)).norm(), 1e-12) << "two halves make the whole";
}

TEST(Pose, SmallAnglesAreNotLost) {
    for (const double angle : {1e-12, 1e-9, 1e-6, 1e-3, 1.0, M_PI}) {
        const Eigen::Quaterniond turned(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()));
        EXPECT_NEAR(angle_between(Eigen::Quaterniond::Identity(), turned), angle, 1e-15 + 1e-12 * angle);
        EXPECT_NEAR(angle_between(turned, Eigen::Quaterniond::Identity()), angle, 1e-15 + 1e-12 * angle);
    }
}

TEST(Pose, TurnAboutACentreKeepsTheCentre) {
    const Eigen::Vector3d centre(0.3, -0.2, 0.5);
    const Pose pose{Eigen::Quaterniond(Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitX())), {0.1, 0.2, 0.9}};
    Twist twist;
    twist << 0.3, -0.1, 0.2, 0, 0, 0;
    EXPECT_LT((perturb_about(pose, twist, centre) * centre - pose * centre).norm(), 1e-15);
    twist << 0, 0, 0, 0.01, 0.02, 0.03;
    EXPECT_LT((perturb_about(pose, twist, centre) * centre - pose * (centre + twist.tail<3>())).norm(), 1e-15);
}

TEST(Pose, FromMatrixTakesTheNearestRotation) {
    const Eigen::Quaterniond truth(Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, 3).normalized()));
    const Eigen::Matrix3d rounded = truth.toRotationMatrix().cast<float>().cast<double>();
    EXPECT_LT(angle_between(Pose::from_matrix(rounded, Eigen::Vector3d::Zero()).rotation, truth), 1e-6);
    EXPECT_LT((Pose::from_matrix(2.0 * truth.toRotationMatrix(), Eigen::Vector3d::Zero()).rotation_matrix() -
               truth.toRotationMatrix())
                  .norm(),
              1e-12);
    EXPECT_NEAR(Pose::from_matrix(-truth.toRotationMatrix(), Eigen::Vector3d::Zero()).rotation_matrix().determinant(),
                1.0, 1e-12)
        << "a reflection becomes a rotation";
}

TEST(Pose, ValidityIsCheckedBeforeRaysAreCast) {
    EXPECT_TRUE(is_valid(Pose::identity()));
    Pose pose;
    pose.translation.x() = std::nan("");
    EXPECT_FALSE(is_valid(pose));
    pose.translation.x() = 1e19;
    EXPECT_FALSE(is_valid(pose));
    pose = {};
    pose.rotation.w() = std::nan("");
    EXPECT_FALSE(is_valid(pose));
    pose.rotation = Eigen::Quaterniond(0, 0, 0, 0);
    EXPECT_FALSE(is_valid(pose));
}

}  // namespace
}  // namespace nearpose
