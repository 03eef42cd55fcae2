#include "core/world/place_in_world.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>

#include "core/base/random.hpp"
#include "core/fit/joint_fit.hpp"
#include "tests/core/world/sightings_of.hpp"

namespace nearpose {
namespace {

const Pose kWorldFromCamera = exp(twist_of(2.1, -0.4, 0.6, 0.3, -0.9, 0.7));
const Pose kCameraFromObject = exp(twist_of(0.3, -0.7, 1.1, 0.02, -0.05, 0.6));

Matrix6d some_covariance() {
    Matrix6d factor = twist_of(0.002, 0.004, 0.001, 0.003, 0.001, 0.0005).asDiagonal();
    factor(3, 1) = 0.002;  // translation and rotation depend on each other
    return factor * factor.transpose();
}

double distance(const Pose& a, const Pose& b) {
    return log(a.inverse() * b).norm();
}

TEST(PlaceInWorld, IsThePoseSeenThroughTheCamera) {
    const PlaceInWorld place = place_in_world(kCameraFromObject, some_covariance(), kWorldFromCamera, {});
    const Eigen::Vector3d point(0.1, 0.2, 0.3);
    EXPECT_LT((place.world_from_object * point - kWorldFromCamera * (kCameraFromObject * point)).norm(), 1e-12);
}

TEST(PlaceInWorld, ACameraKnownExactlyAddsNothingWhereverTheWorldIs) {
    for (const Pose& world_from_camera : {Pose::identity(), kWorldFromCamera}) {
        const PlaceInWorld place =
            place_in_world(kCameraFromObject, some_covariance(), world_from_camera, Matrix6d::Zero());
        EXPECT_EQ(place.covariance, some_covariance());
    }
}

// The poses that errors of this size would really give, however they are composed.
TEST(PlaceInWorld, ThePosesOfSampledErrorsScatterAsTheCovarianceSays) {
    SetupSigmas setup;
    setup.hand_eye_rad = 0.004;
    setup.hand_eye_m = 0.001;
    setup.time_offset_frames = 0.2;
    const SightingOptions arm{.arm_rotation_rad = 0.001, .arm_translation_m = 0.0005};
    const Twist motion = twist_of(0.004, 0.0, 0.02, -0.01, 0.004, 0.02);
    const PlaceInWorld place = place_in_world(kCameraFromObject, some_covariance(), kWorldFromCamera,
                                              camera_pose_covariance(setup, arm, motion));
    const Matrix6d factor = some_covariance().llt().matrixL();
    RandomStream random(5, 0, 0, RandomPurpose::kDiffusion);
    const auto drawn = [&](double rotation_rad, double translation_m) {
        Twist twist;
        for (int i = 0; i < 6; ++i) twist[i] = random.gaussian() * (i < 3 ? rotation_rad : translation_m);
        return twist;
    };
    constexpr int kDraws = 20000;
    Matrix6d sampled = Matrix6d::Zero();
    for (int i = 0; i < kDraws; ++i) {
        const Pose reported = kWorldFromCamera * exp(Twist(setup.time_offset_frames * random.gaussian() * motion)) *
                              exp(drawn(arm.arm_rotation_rad, arm.arm_translation_m)) *
                              exp(drawn(setup.hand_eye_rad, setup.hand_eye_m));
        const Pose seen = kCameraFromObject * exp(Twist(factor * drawn(1.0, 1.0)));
        const Twist off = log(place.world_from_object.inverse() * (reported * seen));
        sampled += off * off.transpose() / kDraws;
    }
    EXPECT_LT((sampled - place.covariance).norm(), 0.03 * place.covariance.norm());
}

TEST(PlaceInWorld, ATurnOfTheCameraShiftsThePartByItsDistance) {
    constexpr double kDistance_m = 0.5, kTurn_rad = 0.002;
    const Pose ahead{kCameraFromObject.rotation, {0.0, 0.0, kDistance_m}};
    SetupSigmas setup;
    setup.hand_eye_rad = kTurn_rad;
    const Matrix6d camera =
        camera_pose_covariance(setup, {.arm_rotation_rad = 0.0, .arm_translation_m = 0.0}, Twist::Zero());
    const Matrix6d covariance = place_in_world(ahead, Matrix6d::Zero(), kWorldFromCamera, camera).covariance;
    const Eigen::Matrix3d R = ahead.rotation_matrix();
    const Eigen::Matrix3d shift = R * covariance.bottomRightCorner<3, 3>() * R.transpose();  // in camera axes
    const double across_m2 = std::pow(kDistance_m * kTurn_rad, 2);
    EXPECT_LT((shift - Eigen::Matrix3d(Eigen::Vector3d(across_m2, across_m2, 0.0).asDiagonal())).norm(),
              1e-9 * across_m2);
    EXPECT_LT((covariance.topLeftCorner<3, 3>() - kTurn_rad * kTurn_rad * Eigen::Matrix3d::Identity()).norm(), 1e-15);
}

// One number for the whole camera: what is late shifts the part along its own way, and in no other direction.
TEST(PlaceInWorld, ALateArmMovesThePartAsTheCameraMoves) {
    const Twist motion = twist_of(0.01, -0.02, 0.03, 0.005, 0.01, -0.02);
    SetupSigmas setup;
    setup.time_offset_frames = 0.1;
    const SightingOptions exact{.arm_rotation_rad = 0.0, .arm_translation_m = 0.0};
    const PlaceInWorld now = place_in_world(kCameraFromObject, Matrix6d::Zero(), kWorldFromCamera,
                                            camera_pose_covariance(setup, exact, motion));
    const Pose late = kWorldFromCamera * exp(Twist(0.1 * motion)) * kCameraFromObject;
    const Twist off = log(now.world_from_object.inverse() * late);
    EXPECT_LT((now.covariance - off * off.transpose()).norm(), 1e-9 * now.covariance.norm());
}

// A spread about the model's centre is mapped about it and then brought to the origin: the same.
TEST(PlaceInWorld, TheMapAboutTheCentreGivesTheSame) {
    const Matrix6d camera = camera_pose_covariance(StillWorldOptions{}.usual, {}, twist_of(0.01, 0, 0, 0, 0.02, 0));
    const Matrix6d map = from_camera_twist(kCameraFromObject, kCentre);
    const Matrix6d expected = some_covariance() + about_origin(map * camera * map.transpose(), kCentre);
    const PlaceInWorld place = place_in_world(kCameraFromObject, some_covariance(), kWorldFromCamera, camera);
    EXPECT_LT((place.covariance - expected).norm(), 1e-12 * expected.norm());
}

TEST(PlaceInWorld, AMotionOfTheCameraIsATwistInObjectAxes) {
    const Twist motion = twist_of(0.3, -0.2, 0.5, 0.1, 0.4, -0.2);  // exact for large ones as well
    const Matrix6d map = from_camera_twist(kCameraFromObject, Eigen::Vector3d::Zero());
    EXPECT_LT(distance(exp(motion) * kCameraFromObject, kCameraFromObject * exp(Twist(map * motion))), 1e-12);
}

}  // namespace
}  // namespace nearpose
