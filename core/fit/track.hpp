// The tracked pose over time: a Gaussian that the arm's motion moves and each observation corrects. Along a direction
// of the pose that the observation determines well, it decides; along one that it leaves open, the prediction holds.
#pragma once

#include <optional>

#include "core/base/pose.hpp"
#include "core/base/statistics.hpp"
#include "core/fit/joint_fit.hpp"

namespace nearpose {

// How far a pose may be from where the arm's motion puts it.
struct MotionNoise {
    double sigma_rotation_rad = 0.001;  // of the measured motion of one frame, about the camera
    double sigma_translation_m = 0.0003;
    double fraction = 0.02;             // of the motion itself: error of the hand-eye calibration
    double unknown_rotation_rad = 0.3;  // sigmas of a frame for which no motion was measured
    double unknown_translation_m = 0.1;
};

// The object's own motion, which nothing measures: learned from what the arm's motion does not explain. Root mean
// square of one frame.
struct ObjectMotion {
    double rotation_rad = 0.0;
    double translation_m = 0.0;
};

struct TrackOptions {
    // Prediction and observation contradict each other where their squared Mahalanobis distance exceeds this.
    double contradicted_chi_square = kChiSquare6_999;
    // How much of a Kalman filter's gain in precision is believed, in 0..1. 1: errors of successive frames are
    // independent; 0: they are the same, so that frames average nothing out.
    double independent_errors = 0.5;
    // What the square of the learned object motion keeps from frame to frame. At 0.7 an object that stands still is
    // believed to stand after about three frames.
    double object_motion_kept = 0.7;
};

// Throws std::invalid_argument naming field, value and bound.
void validate(const TrackOptions& options);

// Covariances are of the twist about the model's centre, in object axes, rotation first.
struct Track {
    Pose camera_from_object;
    Matrix6d covariance = Matrix6d::Zero();
    ObjectMotion object_motion;
    Matrix6d constant_covariance = Matrix6d::Zero();  // to be added: of errors that frames do not average out

    Matrix6d whole_covariance() const { return covariance + constant_covariance; }
};

// The control: the pose moves with the camera. The noise of the arm's motion and the object's own motion widen its
// spread.
void move_track(Track& track, const std::optional<Pose>& now_from_before, const MotionNoise& noise,
                const Eigen::Vector3d& centre_in_object);

// Whether prediction and observation are farther apart than their spreads make likely.
bool contradicts(const Track& predicted, const JointFit& observed, const Eigen::Vector3d& centre_in_object,
                 const TrackOptions& options = {});

// Prediction and observation fused. The mean is that of a Kalman filter (Kalman 1960). The errors of both come from the
// same sensor, though, and are not independent: the variance is a mean, by `independent_errors`, of the Kalman filter's
// and of the smaller of the two. It is taken along each direction of the basis in which both covariances are diagonal.
// A prediction that the observation contradicts is left out: the object was moved.
Track correct_track(const Track& predicted, const JointFit& observed, const Eigen::Vector3d& centre_in_object,
                    const TrackOptions& options = {});

}  // namespace nearpose
