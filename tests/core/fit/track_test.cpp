#include "core/fit/track.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>

#include "core/base/random.hpp"

namespace nearpose {
namespace {

const Eigen::Vector3d kCentre(0.1, -0.05, 0.02);
const Pose kPose{Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized())), {0.1, 0.0, 0.5}};

Matrix6d diagonal(double rotation_rad, double translation_m) {
    Twist variances;
    variances << Eigen::Vector3d::Constant(rotation_rad * rotation_rad),
        Eigen::Vector3d::Constant(translation_m * translation_m);
    return Matrix6d(variances.asDiagonal());
}

Twist twist(double rx, double ry, double rz, double x, double y, double z) {
    Twist t;
    t << rx, ry, rz, x, y, z;
    return t;
}

double centre_distance_m(const Pose& a, const Pose& b) {
    return (a * kCentre - b * kCentre).norm();
}

TEST(Track, TheArmsMotionMovesThePoseAndWidensItsSpread) {
    const Pose motion = exp(twist(0.02, 0, 0.01, 0.01, 0, -0.02));
    Track track{kPose, diagonal(0.001, 0.0001), {}};
    const Matrix6d before = track.covariance;
    move_track(track, motion, {}, kCentre);
    EXPECT_LT(centre_distance_m(track.camera_from_object, motion * kPose), 1e-12);
    const Eigen::SelfAdjointEigenSolver<Matrix6d> grown(track.covariance - before);
    EXPECT_GT(grown.eigenvalues().minCoeff(), 0.0) << "in every direction";
}

TEST(Track, APredictionIsContradictedBeyondTheChiSquareOfBothSpreads) {
    // Along one axis, with 3 and 4 mm of spread: 5 mm together. 22.46 is 4.74 squared.
    const Track track{kPose, diagonal(0.001, 0.003), {}};
    JointFit fit;
    fit.covariance = diagonal(0.001, 0.004);
    fit.camera_from_object = perturb_about(kPose, twist(0, 0, 0, 0, 4.73 * 0.005, 0), kCentre);
    EXPECT_FALSE(contradicts(track, fit, kCentre));
    fit.camera_from_object = perturb_about(kPose, twist(0, 0, 0, 0, 4.75 * 0.005, 0), kCentre);
    EXPECT_TRUE(contradicts(track, fit, kCentre));
}

TEST(Track, TheAddedSpreadIsTheScatterOfNoisyMotions) {
    // Errors of the measured motion are drawn in camera axes about the camera, and compared as twists about the centre.
    MotionNoise noise;
    noise.sigma_rotation_rad = 0.004;
    noise.sigma_translation_m = 0.001;
    noise.fraction = 0.0;
    Track track{kPose, Matrix6d::Zero(), {}};
    move_track(track, Pose::identity(), noise, kCentre);
    RandomStream random(3, 0, 0, RandomPurpose::kDiffusion);
    constexpr int kTrials = 4000;
    Matrix6d scatter = Matrix6d::Zero();
    for (int trial = 0; trial < kTrials; ++trial) {
        Twist error;
        for (int i = 0; i < 6; ++i) error[i] = (i < 3 ? 0.004 : 0.001) * random.gaussian();
        const Pose moved = exp(error) * kPose;
        Twist about;
        about.head<3>() = log(Pose{kPose.rotation.conjugate() * moved.rotation, {0, 0, 0}}).head<3>();
        about.tail<3>() = kPose.rotation.conjugate() * (moved * kCentre - kPose * kCentre);
        scatter += about * about.transpose() / kTrials;
    }
    for (int i = 0; i < 6; ++i) EXPECT_NEAR(scatter(i, i) / track.covariance(i, i), 1.0, 0.12) << i;
}

TEST(Track, AlongWeakDirectionsThePredictionHoldsAlongStrongOnesTheObservationDecides) {
    const Track predicted{kPose, diagonal(0.001, 0.0005), {}};
    JointFit observed;
    observed.camera_from_object = perturb_about(kPose, twist(0, 0, 0, 0.03, 0.0004, 0), kCentre);
    observed.covariance = diagonal(0.001, 0.00005);
    observed.covariance(3, 3) = 0.05 * 0.05;  // x is hardly observed
    const Track corrected = correct_track(predicted, observed, kCentre);
    const Eigen::Vector3d moved =
        kPose.rotation.conjugate() * (corrected.camera_from_object * kCentre - kPose * kCentre);
    EXPECT_NEAR(moved.x(), 0.0, 0.0001) << "300 mm of 50 mm sigma against 0.5 mm: the prediction";
    EXPECT_NEAR(moved.y(), 0.0004, 0.00002);
    EXPECT_LT(std::sqrt(corrected.covariance(3, 3)), 0.0006);
    EXPECT_LT(std::sqrt(corrected.covariance(4, 4)), 0.00006);
}

TEST(Track, WithIndependentErrorsItIsAKalmanFilter) {
    const Track predicted{kPose, diagonal(0.001, 0.0005), {}};
    JointFit observed;
    observed.camera_from_object = perturb_about(kPose, twist(0.001, 0, 0, 0, 0.0003, 0), kCentre);
    observed.covariance = diagonal(0.002, 0.0004);
    TrackOptions options;
    options.independent_errors = 1.0;
    const Matrix6d kalman = (predicted.covariance.inverse() + observed.covariance.inverse()).inverse();
    const Matrix6d covariance = correct_track(predicted, observed, kCentre, options).covariance;
    EXPECT_LT((covariance - kalman).norm(), 1e-9 * kalman.norm());
    options.independent_errors = 0.0;
    const Matrix6d shared = correct_track(predicted, observed, kCentre, options).covariance;
    EXPECT_LT((shared - diagonal(0.001, 0.0004)).norm(), 1e-9 * shared.norm()) << "the better of both, no more";
}

TEST(Track, StandingStillTheSpreadDoesNotShrinkForEver) {
    Track track{kPose, diagonal(0.002, 0.0003), {}};
    const JointFit observed{kPose, diagonal(0.002, 0.0003), 1000};
    for (int frame = 0; frame < 200; ++frame) {
        move_track(track, Pose::identity(), {}, kCentre);
        track = correct_track(track, observed, kCentre);
    }
    EXPECT_GT(std::sqrt(track.covariance(3, 3)), 0.6 * 0.0003) << "successive frames share the sensor's errors";
}

TEST(Track, ErrorsCommonToAllFramesAreNotAveragedOut) {
    Track track{kPose, diagonal(0.002, 0.0003), {}};
    const JointFit observed{kPose, diagonal(0.002, 0.0003), 1000, diagonal(0.0, 0.0007)};
    for (int frame = 0; frame < 50; ++frame) {
        move_track(track, Pose::identity(), {}, kCentre);
        track = correct_track(track, observed, kCentre);
    }
    EXPECT_NEAR(track.whole_covariance()(3, 3), track.covariance(3, 3) + 0.0007 * 0.0007, 1e-12);
}

TEST(Track, APredictionThatTheObservationContradictsIsRejected) {
    const Track predicted{kPose, diagonal(0.001, 0.0003), {}};
    JointFit observed;
    observed.camera_from_object = perturb_about(kPose, twist(0, 0, 0, 0.02, 0, 0), kCentre);
    observed.covariance = diagonal(0.001, 0.0002);
    const Track corrected = correct_track(predicted, observed, kCentre);
    EXPECT_LT(centre_distance_m(corrected.camera_from_object, observed.camera_from_object), 1e-12);
    EXPECT_NEAR(corrected.object_motion.translation_m, 0.02, 0.001) << "it learns that the object moves by itself";
}

TEST(Track, AMovingObjectIsFollowedWithoutLag) {
    Track track{kPose, diagonal(0.001, 0.0003), {}};
    double worst_m = 0.0;
    for (int frame = 1; frame <= 30; ++frame) {
        move_track(track, Pose::identity(), {}, kCentre);
        const JointFit observed{perturb_about(kPose, twist(0, 0, 0, 0.001 * frame, 0, 0), kCentre),
                                diagonal(0.001, 0.0002), 1000};
        track = correct_track(track, observed, kCentre);
        if (frame > 3)
            worst_m = std::max(worst_m, centre_distance_m(track.camera_from_object, observed.camera_from_object));
    }
    EXPECT_LT(worst_m, 0.0002) << "1 mm a frame, observed to 0.2 mm: within that";
}

TEST(Track, CovariancesMoveBetweenCentreAndOrigin) {
    const Matrix6d about = diagonal(0.01, 0.001);
    EXPECT_LT((about_centre(about_origin(about, kCentre), kCentre) - about).norm(), 1e-12);
    // A turn about the centre moves the origin by the lever arm.
    EXPECT_NEAR(about_origin(about, kCentre)(3, 3),
                0.001 * 0.001 + 0.01 * 0.01 * (kCentre.y() * kCentre.y() + kCentre.z() * kCentre.z()), 1e-12);
}

}  // namespace
}  // namespace nearpose
