// The set-up's errors from a recording: the part is tracked, the errors are estimated from its sightings, and both
// again with the set-up corrected, since a fit's dependence on them is known to first order only.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "apps/runs/estimator_setup.hpp"
#include "apps/runs/frame_source.hpp"
#include "apps/set_up/setup_errors.hpp"
#include "optim/setup_calibration.hpp"

namespace nearpose::program {

struct CalibrationOptions {
    int passes = 3;
    // No further pass where all that was left is below so many of its standard deviations.
    double done_sigmas = 0.2;
    SetupVector prior_sigma = SetupCalibrationOptions{}.prior_sigma;  // times in frames
};

struct Calibration {
    bool solved = false;
    SetupErrors errors;
    // Standard deviations of the errors, in the order and units of the unknowns: times in frames of `frame_s`.
    SetupVector sigma = SetupVector::Zero();
    SetupVector prior_sigma = SetupVector::Zero();
    double frame_s = 0.0;
    int frames = 0, sightings = 0;
    double unit_sigma = 0.0;
    // Of the last pass, which had the errors corrected: an image that still moves otherwise than the arm.
    MotionMistake mistake = MotionMistake::kNone;
};

// Called after each frame; false: stop, nothing is solved.
using FrameDone = std::function<bool()>;

// `centre_in_object` of the model's box; `views` are those of the setup. Frames that cannot be read are empty ones.
Calibration calibrate(const std::shared_ptr<const FrameSource>& given, const Eigen::Vector3d& centre_in_object,
                      const EstimatorSetup& setup, const std::shared_ptr<const ViewGenerator>& views,
                      const FrameDone& frame_done, const CalibrationOptions& options = {});

// The largest figures: "focal length +0.98 %, principal point 4.9 px, ... off".
std::string in_one_line(const Calibration& calibration);

}  // namespace nearpose::program
