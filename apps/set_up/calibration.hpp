// The set-up's errors from a recording: the part is tracked, the errors are estimated from its sightings, and both
// again with the set-up corrected, since a fit's dependence on them is known to first order only.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/runs/estimator_setup.hpp"
#include "apps/runs/frame_source.hpp"
#include "apps/set_up/setup_errors.hpp"
#include "optim/setup_calibration.hpp"

namespace nearpose::program {

struct CalibrationOptions {
    int passes = 3;
    // No further pass where all that was left is below so many of its standard deviations.
    double done_sigmas = 0.2;
    // What may be at fault, of setup_parts(). Not given: the recording decides.
    std::optional<std::vector<std::string>> unknown;
    // A part is taken to be at fault where that makes the sightings likelier by so much [nats]; one as likely, but for
    // less than that, is taken with it, since the recording does not tell which.
    double min_log_odds = 3.0;
};

struct Calibration {
    bool solved = false;
    SetupErrors errors;  // of the parts at fault, to be corrected; the others are left as they are given
    // All that were estimated and their standard deviations, in the order of the unknowns: times in frames of
    // `frame_s`.
    SetupVector estimate = SetupVector::Zero();
    SetupVector sigma = SetupVector::Zero();
    SetupVector prior_sigma = SetupVector::Zero();
    std::vector<std::string> unknown;  // parts that were taken to be at fault; the others to be as good as usual
    double frame_s = 0.0;
    int frames = 0, sightings = 0;
    double unit_sigma = 0.0;
    // Of the last pass, which had the errors corrected: an image that still moves otherwise than the arm.
    MotionMistake mistake = MotionMistake::kNone;
};

// Called after each frame; false: stop, and the calibration is not solved.
using FrameDone = std::function<bool()>;

// The parts of a set-up whose fault makes the sightings likelier, one after the other; `prior_mean` of the errors.
std::vector<std::string> parts_at_fault(const std::vector<Sighting>& sightings, const Eigen::Vector3d& centre_in_object,
                                        const SetupVector& prior_mean, double min_log_odds);

// `centre_in_object` of the model's box; `views` are those of the setup. Frames that cannot be read are empty ones.
Calibration calibrate(const std::shared_ptr<const FrameSource>& given, const Eigen::Vector3d& centre_in_object,
                      const EstimatorSetup& setup, const std::shared_ptr<const ViewGenerator>& views,
                      const FrameDone& frame_done, const CalibrationOptions& options = {});

// What is corrected: "off by: focal length 0.98 %, principal point 4.9 px, ...".
std::string in_one_line(const Calibration& calibration);

}  // namespace nearpose::program
