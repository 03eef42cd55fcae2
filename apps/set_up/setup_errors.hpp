// By how much what a recording says of its set-up differs from the truth.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/base/camera.hpp"
#include "core/base/pose.hpp"
#include "optim/setup_calibration.hpp"

namespace nearpose::program {

// What was given is larger than the truth by so much. Zeros: the set-up is as it is given.
struct SetupErrors {
    double focal_length = 0.0;  // share of itself, of both axes
    Eigen::Vector2d principal_point_pixels = Eigen::Vector2d::Zero();
    double depth_scale = 0.0;    // share of itself
    Pose given_from_camera;      // of the hand-eye calibration: how the camera lies where the arm says that it is
    double time_offset_s = 0.0;  // the arm's poses are so much later than their images
};

// In the order of the unknowns; a frame takes `frame_s`.
SetupVector in_order(const SetupErrors& errors, double frame_s);
SetupErrors errors_of(const SetupVector& vector, double frame_s);

// Parts of a set-up that can be at fault: focal, principal-point, depth-scale, hand-eye, time.
const std::vector<std::string>& setup_parts();
// Prior standard deviations in the order of the unknowns: wide for those parts, for the others those of a usual set-up.
// Throws std::invalid_argument for a name that is none of them.
SetupVector prior_with_unknown(const std::vector<std::string>& parts);

// The errors of those parts; zeros for the others. Throws as above.
SetupVector only_of(const std::vector<std::string>& parts, const SetupVector& errors);

// Whether an error is told from zero.
bool is_told_from_zero(double error, double sigma);

// Errors that were found first, and then those that were left after their correction.
SetupErrors composed(const SetupErrors& first, const SetupErrors& left);

// What is true, from what was given.
PinholeCamera corrected(PinholeCamera given, const SetupErrors& errors);
Pose corrected(const Pose& given_from_world, const SetupErrors& errors);  // gives camera_from_world

}  // namespace nearpose::program
