#include "core/fit/track.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/base/check.hpp"

namespace nearpose {
namespace {

// Covariance of the twist about the centre that an error of the camera's motion causes. That error is a rotation and a
// translation in camera axes.
Matrix6d motion_covariance(const Pose& camera_from_object, const Eigen::Vector3d& centre_in_object, double rotation_rad,
                           double translation_m) {
    const Matrix6d map = from_camera_twist(camera_from_object, centre_in_object);
    Twist variances;
    variances << Eigen::Vector3d::Constant(rotation_rad * rotation_rad),
        Eigen::Vector3d::Constant(translation_m * translation_m);
    return map * variances.asDiagonal() * map.transpose();
}

void add_to_pose(Track& track, double rotation_rad, double translation_m) {
    for (int i = 0; i < 3; ++i) {
        track.covariance(i, i) += rotation_rad * rotation_rad;
        track.covariance(3 + i, 3 + i) += translation_m * translation_m;
    }
}

// The object's own motion is what the spread of the prediction does not explain of the correction. Where the prediction
// was rejected, all of the correction is the object's motion.
void learn_motion(const Track& predicted, Track& corrected, bool rejected, const Eigen::Vector3d& centre,
                  const TrackOptions& options) {
    const double kept = options.object_motion_kept;
    const Twist moved = twist_about(predicted.camera_from_object, corrected.camera_from_object, centre);
    const auto learned = [&](double before, const Eigen::Vector3d& part, double expected) {
        const double unexplained = std::max(0.0, part.squaredNorm() - (rejected ? 0.0 : expected));
        return std::sqrt(rejected ? std::max(before * before, unexplained)
                                  : kept * before * before + (1.0 - kept) * unexplained);
    };
    ObjectMotion& motion = corrected.object_motion;
    motion.rotation_rad =
        learned(motion.rotation_rad, moved.head<3>(), predicted.covariance.diagonal().head<3>().sum());
    motion.translation_m =
        learned(motion.translation_m, moved.tail<3>(), predicted.covariance.diagonal().segment<3>(3).sum());
}

}  // namespace

void validate(const TrackOptions& options) {
    check_option("track.contradicted_chi_square", options.contradicted_chi_square, 0.0, 1e6);
    check_option("track.independent_errors", options.independent_errors, 0.0, 1.0);
    check_option("track.object_motion_kept", options.object_motion_kept, 0.0, 1.0);
}

void move_track(Track& track, const std::optional<Pose>& now_from_before, const MotionNoise& noise,
                const Eigen::Vector3d& centre_in_object) {
    double rotation_rad = noise.unknown_rotation_rad, translation_m = noise.unknown_translation_m;
    if (now_from_before) {
        track.camera_from_object = *now_from_before * track.camera_from_object;
        const Twist motion = log(*now_from_before);
        rotation_rad = std::hypot(noise.sigma_rotation_rad, noise.fraction * motion.head<3>().norm());
        translation_m = std::hypot(noise.sigma_translation_m, noise.fraction * motion.tail<3>().norm());
    }
    track.covariance += motion_covariance(track.camera_from_object, centre_in_object, rotation_rad, translation_m);
    add_to_pose(track, track.object_motion.rotation_rad, track.object_motion.translation_m);
}

bool contradicts(const Track& predicted, const JointFit& observed, const Eigen::Vector3d& centre_in_object,
                 const TrackOptions& options) {
    const Twist apart = twist_about(observed.camera_from_object, predicted.camera_from_object, centre_in_object);
    const Matrix6d sum = predicted.covariance + observed.covariance;
    return apart.dot(sum.llt().solve(apart)) > options.contradicted_chi_square;
}

Track correct_track(const Track& predicted, const JointFit& observed, const Eigen::Vector3d& centre_in_object,
                    const TrackOptions& options) {
    const Twist to_prediction =
        twist_about(observed.camera_from_object, predicted.camera_from_object, centre_in_object);
    const bool rejected = contradicts(predicted, observed, centre_in_object, options);
    Track track{observed.camera_from_object, observed.covariance, predicted.object_motion,
                observed.constant_covariance};
    if (!rejected) {
        // For the columns v of V, v^T P v = d and v^T R v = 1, with P of the prediction and R of the observation: in
        // the dual basis of V both are diagonal.
        const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix6d> solver(predicted.covariance, observed.covariance);
        const Matrix6d V = solver.eigenvectors();
        const Matrix6d dual = V.transpose().inverse();
        const Eigen::Array<double, 6, 1> d = solver.eigenvalues().array().max(1e-12);
        const Eigen::Array<double, 6, 1> share = 1.0 / (1.0 + d);  // of the prediction in the mean
        const Eigen::Array<double, 6, 1> kalman = d * share, better = d.min(1.0);
        const Eigen::Array<double, 6, 1> variances =
            options.independent_errors * kalman + (1.0 - options.independent_errors) * better;
        const Twist shift = dual * (share * (V.transpose() * to_prediction).array()).matrix();
        track.camera_from_object = perturb_about(observed.camera_from_object, shift, centre_in_object);
        track.covariance = dual * variances.matrix().asDiagonal() * dual.transpose();
    }
    learn_motion(predicted, track, rejected, centre_in_object, options);
    return track;
}

}  // namespace nearpose
