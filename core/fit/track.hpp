// The tracked pose over time: a Gaussian that the arm's motion carries and each observation corrects. Where the
// observation says much about a direction of the pose, it decides; where it says nothing, the arm's motion holds.
#pragma once

#include <optional>

#include "core/base/pose.hpp"
#include "core/fit/joint_fit.hpp"

namespace nearpose {

// How far a pose may be from where the arm's motion puts it.
struct MotionNoise {
    double sigma_rotation_rad = 0.001;  // of the measured motion of one frame, about the camera
    double sigma_translation_m = 0.0003;
    double fraction = 0.02;             // of the motion itself: an ill-calibrated hand-eye transform
    double unknown_rotation_rad = 0.3;  // where no motion was measured
    double unknown_translation_m = 0.1;
};

// The object's own motion, which nobody measures: learned from what the arm's motion does not explain. Root mean
// square, a frame.
struct ObjectMotion {
    double rotation_rad = 0.0;
    double translation_m = 0.0;
};

struct Track {
    Pose camera_from_object;
    Matrix6d covariance = Matrix6d::Zero();  // of the twist about the model's centre, in object axes, rotation first
    ObjectMotion object_motion;
    Matrix6d constant_covariance = Matrix6d::Zero();  // to be added: of what frames do not average out

    Matrix6d whole_covariance() const { return covariance + constant_covariance; }
};

// The control: the pose moves with the camera, and the arm's and the object's motion widen its spread.
void move_track(Track& track, const std::optional<Pose>& now_from_before, const MotionNoise& noise,
                const Eigen::Vector3d& centre_in_object);

// Whether they are farther apart than their spreads make likely (99.9 %).
bool contradicts(const Track& predicted, const JointFit& observed, const Eigen::Vector3d& centre_in_object);

// Prediction and observation brought together. The errors of both come from the same sensor, frame after frame, so the
// mean is that of a Kalman filter, but along each direction (of the basis in which both are independent) the spread
// falls to no less than half-way between a Kalman filter's and the better of the two. A prediction that the observation
// contradicts is left out: the object was moved.
Track correct_track(const Track& predicted, const JointFit& observed, const Eigen::Vector3d& centre_in_object);

}  // namespace nearpose
