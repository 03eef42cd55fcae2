#include "apps/set_up/calibration.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <string>
#include <utility>
#include <vector>

#include "apps/base/degrees.hpp"
#include "apps/base/number_text.hpp"
#include "apps/runs/camera_motion.hpp"
#include "apps/set_up/corrected_source.hpp"

namespace nearpose::program {
namespace {

// The estimator's sightings, each with the camera's motion at its frame.
struct Tracked {
    std::vector<Sighting> sightings;
    MotionMistake mistake = MotionMistake::kNone;
    bool complete = false;
};

FrameData read_or_empty(const FrameSource& source, std::size_t index) {
    try {
        return source.load(index);
    } catch (const std::exception&) {
        return {};
    }
}

// The camera's motion about a frame in the usual time between two, by the poses `reach` frames before and after.
Twist motion_over(const std::vector<FrameInfo>& frames, std::size_t index, std::size_t reach, double frame_s) {
    const std::size_t before = index - std::min(index, reach);
    const std::size_t after = std::min(index + reach, frames.size() - 1);
    const double between_s = frames[after].stamp_s - frames[before].stamp_s;
    if (!frames[before].camera_from_world || !frames[after].camera_from_world || between_s <= 0.0) return Twist::Zero();
    const Pose before_from_after = *frames[before].camera_from_world * frames[after].camera_from_world->inverse();
    return frame_s / between_s * log(before_from_after);
}

// The camera's motion at a frame. Errors of the arm's poses in it would pass for errors of the time: the frame's own
// pose has no part in it, and the poses are as far apart as the motion stays the same (Lepski's choice).
Twist motion_at(const std::vector<FrameInfo>& frames, std::size_t index, double frame_s) {
    constexpr std::size_t kLongestReach = 3;
    constexpr double kSigmas = 3.0;
    const SightingOptions arm;
    const Twist nearest = motion_over(frames, index, 1, frame_s);
    for (std::size_t reach = kLongestReach; reach > 1; --reach) {
        const Twist motion = motion_over(frames, index, reach, frame_s);
        const Twist change = motion - nearest;
        if (change.head<3>().norm() < kSigmas * arm.arm_rotation_rad &&
            change.tail<3>().norm() < kSigmas * arm.arm_translation_m)
            return motion;
    }
    return nearest;
}

// Whether the last sighting is of the present frame.
bool is_of_now(const Sightings& sightings) {
    return !sightings.kept.empty() &&
           sightings.kept.back().arm_from_camera.translation == sightings.arm_from_camera.translation &&
           sightings.kept.back().arm_from_camera.rotation.coeffs() == sightings.arm_from_camera.rotation.coeffs();
}

Tracked track(const FrameSource& source, double frame_s, PoseEstimator estimator, const FrameDone& frame_done) {
    Tracked tracked;
    std::vector<std::size_t> frame_of;  // parallel to the sightings
    for (std::size_t index = 0; index < source.frames().size(); ++index) {
        const Observation observation = observe_frame(source.frames()[index], read_or_empty(source, index));
        const UpdateResult result = estimator.update(observation, control_of(source.frames(), index));
        const Sightings& sightings = estimator.belief().sightings;
        frame_of.resize(sightings.kept.size(), index);
        if (is_of_now(sightings)) frame_of.back() = index;
        if (result.arm.motion.mistake != MotionMistake::kNone) tracked.mistake = result.arm.motion.mistake;
        if (!frame_done()) return tracked;
    }
    tracked.sightings = estimator.belief().sightings.kept;
    for (std::size_t k = 0; k < tracked.sightings.size(); ++k)
        tracked.sightings[k].camera_motion = motion_at(source.frames(), frame_of[k], frame_s);
    tracked.complete = true;
    return tracked;
}

bool is_done(const SetupVector& left, const SetupVector& sigma, double done_sigmas) {
    return (left.cwiseAbs().array() < done_sigmas * sigma.array()).all();
}

SetupCalibration solved_with(const std::vector<std::string>& unknown, const std::vector<Sighting>& sightings,
                             const Eigen::Vector3d& centre_in_object, const SetupVector& prior_mean) {
    SetupCalibrationOptions solver;
    solver.prior_sigma = prior_with_unknown(unknown);
    solver.prior_mean = prior_mean;
    return calibrate_setup(sightings, centre_in_object, solver);
}

// Whether an error of the part is told from zero though it was taken to be as good as usual.
bool is_contradicted(const std::string& part, const SetupCalibration& found) {
    const SetupVector errors = only_of({part}, found.errors);
    for (Eigen::Index i = 0; i < kSetupUnknowns; ++i)
        if (is_told_from_zero(errors[i], std::sqrt(found.covariance(i, i)))) return true;
    return false;
}

}  // namespace

std::vector<std::string> parts_at_fault(const std::vector<Sighting>& sightings, const Eigen::Vector3d& centre_in_object,
                                        const SetupVector& prior_mean, double min_log_odds) {
    std::vector<std::string> chosen;
    SetupCalibration before = solved_with(chosen, sightings, centre_in_object, prior_mean);
    while (chosen.size() < setup_parts().size()) {
        std::vector<std::pair<double, std::string>> gains;
        for (const std::string& part : setup_parts()) {
            if (std::find(chosen.begin(), chosen.end(), part) != chosen.end()) continue;
            std::vector<std::string> with = chosen;
            with.push_back(part);
            const SetupCalibration found = solved_with(with, sightings, centre_in_object, prior_mean);
            if (found.solved) gains.emplace_back(found.log_evidence - before.log_evidence, part);
        }
        if (!before.solved || gains.empty()) break;
        const double most = std::max_element(gains.begin(), gains.end())->first;
        const std::size_t chosen_before = chosen.size();
        for (const auto& [gain, part] : gains) {
            const bool likely = gain > std::max(min_log_odds, most - min_log_odds);
            if (likely || (most < min_log_odds && is_contradicted(part, before))) chosen.push_back(part);
        }
        if (chosen.size() == chosen_before) break;
        before = solved_with(chosen, sightings, centre_in_object, prior_mean);
    }
    return chosen;
}

Calibration calibrate(const std::shared_ptr<const FrameSource>& given, const Eigen::Vector3d& centre_in_object,
                      const EstimatorSetup& setup, const std::shared_ptr<const ViewGenerator>& views,
                      const FrameDone& frame_done, const CalibrationOptions& options) {
    constexpr int kMostSightings = 10000;
    EstimatorSetup keeping_all = setup;
    keeping_all.max_sightings = std::min(static_cast<int>(given->frames().size()) + 2, kMostSightings);
    const PoseEstimator start = make_estimator(keeping_all, views);
    Calibration calibration;
    calibration.frames = static_cast<int>(given->frames().size());
    const double step_s = usual_step_s(*given);
    const double frame_s = step_s > 0.0 ? step_s : 1.0;  // without times nothing shows the time between arm and image
    calibration.frame_s = frame_s;
    for (int pass = 0; pass < options.passes; ++pass) {
        const Tracked tracked = track(*corrected_source(given, calibration.errors), frame_s, start, frame_done);
        calibration.mistake = tracked.mistake;
        calibration.solved = false;
        if (!tracked.complete) return calibration;
        const SetupVector mean = -in_order(calibration.errors, frame_s);  // the whole error is about zero
        if (pass == 0) {
            calibration.unknown = options.unknown
                                      ? *options.unknown
                                      : parts_at_fault(tracked.sightings, centre_in_object, mean, options.min_log_odds);
            calibration.prior_sigma = prior_with_unknown(calibration.unknown);
        }
        const SetupCalibration left = solved_with(calibration.unknown, tracked.sightings, centre_in_object, mean);
        calibration.sightings = left.sightings;
        if (!left.solved) return calibration;
        calibration.errors =
            composed(calibration.errors, errors_of(only_of(calibration.unknown, left.errors), frame_s));
        calibration.estimate =
            in_order(calibration.errors, frame_s) + left.errors - only_of(calibration.unknown, left.errors);
        calibration.sigma = left.covariance.diagonal().cwiseSqrt();
        calibration.unit_sigma = left.unit_sigma;
        calibration.solved = true;
        if (is_done(only_of(calibration.unknown, left.errors), calibration.sigma, options.done_sigmas)) break;
    }
    return calibration;
}

std::string in_one_line(const Calibration& calibration) {
    using data_set::format_fixed;
    const SetupErrors& errors = calibration.errors;
    const double turn_rad = angle_between(Eigen::Quaterniond::Identity(), errors.given_from_camera.rotation);
    return "off by: focal length " + format_fixed(1e2 * errors.focal_length, 2) + " %, principal point " +
           format_fixed(errors.principal_point_pixels.norm(), 1) + " px, depth scale " +
           format_fixed(1e2 * errors.depth_scale, 2) + " %, hand-eye " +
           format_fixed(1e3 * errors.given_from_camera.translation.norm(), 1) + " mm, " +
           format_fixed(kDegrees * turn_rad, 2) + " degrees, time " + format_fixed(1e3 * errors.time_offset_s, 1) +
           " ms";
}

}  // namespace nearpose::program
