#include "core/world/still_world.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/base/check.hpp"

namespace nearpose {
namespace {

// The unknowns, in this order.
constexpr Eigen::Index kPlace = 0;                            // of the part: a twist
constexpr Eigen::Index kSetup = 6;                            // errors that have a SetupEffect
constexpr Eigen::Index kHandEyeTurn = kSetup + kSetupErrors;  // in camera axes
constexpr Eigen::Index kHandEyeShift = kHandEyeTurn + 3;
constexpr Eigen::Index kTime = kHandEyeShift + 3;  // frames
constexpr Eigen::Index kVelocity = kTime + 1;      // a twist a frame
constexpr Eigen::Index kNumUnknowns = kVelocity + 6;
using Unknowns = Eigen::Matrix<double, kNumUnknowns, 1>;
using Square = Eigen::Matrix<double, kNumUnknowns, kNumUnknowns>;

// Normal equations; of the symmetric matrix the lower half is kept.
struct Sums {
    Square information = Square::Zero();
    Unknowns gradient = Unknowns::Zero();
};

// The rows of the velocity are those of the place times the frames gone by, so that they need no products of their own.
void add(const Sighting& sighting, const Sighting& first, double frames, const Eigen::Vector3d& centre,
         const StillWorldOptions& options, Sums& sums) {
    constexpr Eigen::Index kOthers = kVelocity;
    const Matrix6d from_camera = from_camera_twist(sighting.camera_from_object, centre);
    Eigen::Matrix<double, 6, kOthers> rows;
    rows << Matrix6d::Identity(), sighting.setup_effect, from_camera, from_camera * sighting.camera_motion;
    const Eigen::LLT<Matrix6d> factor(sighting.covariance * options.sightings_per_error);
    const Eigen::Matrix<double, 6, kOthers> whitened = factor.matrixL().solve(rows);
    const Twist off = factor.matrixL().solve(twist_about(first.arm_from_object(), sighting.arm_from_object(), centre));
    const Eigen::Matrix<double, kOthers, kOthers> information = whitened.transpose().lazyProduct(whitened);
    const Eigen::Matrix<double, kOthers, 1> gradient = whitened.transpose().lazyProduct(off);
    sums.information.topLeftCorner<kOthers, kOthers>() += information;
    sums.information.bottomLeftCorner<6, kOthers>() += frames * information.topRows<6>();
    sums.information.bottomRightCorner<6, 6>() += frames * frames * information.topLeftCorner<6, 6>();
    sums.gradient.head<kOthers>() += gradient;
    sums.gradient.tail<6>() += frames * gradient.head<6>();
}

void set(Unknowns& variances, Eigen::Index first, Eigen::Index count, double sigma) {
    variances.segment(first, count).setConstant(sigma * sigma);
}

// Prior variances under a cause.
Unknowns prior_of(Cause cause, const StillWorldOptions& options) {
    const auto sigma = [&](Cause of, double SetupSigmas::*field) {
        return cause == of ? options.faulty.*field : options.usual.*field;
    };
    constexpr double kAnywhere = 1e3;
    Unknowns variances;
    set(variances, kPlace, 6, kAnywhere);
    set(variances, kVelocity, 3, sigma(Cause::kObjectMotion, &SetupSigmas::turn_rad));
    set(variances, kVelocity + 3, 3, sigma(Cause::kObjectMotion, &SetupSigmas::shift_m));
    set(variances, kSetup + kFocalLengthError, 1, sigma(Cause::kFocalLength, &SetupSigmas::focal_length));
    set(variances, kSetup + kImageColumns, 2, sigma(Cause::kPrincipalPoint, &SetupSigmas::principal_point_pixels));
    set(variances, kSetup + kDepthScaleError, 1, sigma(Cause::kDepthScale, &SetupSigmas::depth_scale));
    set(variances, kHandEyeTurn, 3, sigma(Cause::kHandEyeRotation, &SetupSigmas::hand_eye_rad));
    set(variances, kHandEyeShift, 3, sigma(Cause::kHandEyeTranslation, &SetupSigmas::hand_eye_m));
    set(variances, kTime, 1, sigma(Cause::kTimeOffset, &SetupSigmas::time_offset_frames));
    return variances;
}

// Log-evidence of a prior, but for what all priors share, and the present shift that the set-up's errors cause.
CauseEvidence evidence_of(const Sums& sums, const Unknowns& variances, const Sighting& now) {
    const Unknowns sigmas = variances.cwiseSqrt();
    const Square whitened = Square::Identity() + Square(sigmas.asDiagonal() * sums.information * sigmas.asDiagonal());
    const Eigen::LLT<Square> factor(whitened);
    const Unknowns gradient = sigmas.cwiseProduct(sums.gradient);
    const Unknowns step = factor.solve(gradient);
    CauseEvidence evidence;
    evidence.log_odds = 0.5 * gradient.dot(step) - Unknowns(factor.matrixLLT().diagonal()).array().log().sum();
    Eigen::Matrix<double, 3, kNumUnknowns> shift = Eigen::Matrix<double, 3, kNumUnknowns>::Zero();
    shift.middleCols<kSetupErrors>(kSetup) = now.setup_effect.bottomRows<3>();
    shift = shift * sigmas.asDiagonal();
    evidence.shift_m = (shift * step).norm();
    evidence.sigma_m = std::sqrt((shift * factor.solve(shift.transpose())).trace());
    return evidence;
}

bool is_set_up(Cause cause) {
    return cause != Cause::kNone && cause != Cause::kObjectMotion;
}

}  // namespace

const char* to_string(Cause cause) {
    switch (cause) {
        case Cause::kNone:
            return "nothing";
        case Cause::kObjectMotion:
            return "motion of the part";
        case Cause::kPrincipalPoint:
            return "principal point";
        case Cause::kFocalLength:
            return "focal length";
        case Cause::kDepthScale:
            return "depth scale";
        case Cause::kHandEyeRotation:
            return "hand-eye rotation";
        case Cause::kHandEyeTranslation:
            return "hand-eye translation";
        case Cause::kTimeOffset:
            return "time offset";
    }
    return "";
}

void validate(const StillWorldOptions& options) {
    check_option("still_world.sightings_per_error", options.sightings_per_error, 1.0, 1e3);
    check_option("still_world.min_sightings", options.min_sightings, 2, 10000);
    check_option("still_world.min_log_odds", options.min_log_odds, 0.0, 1e6);
    check_option("still_world.as_likely_nats", options.as_likely_nats, 0.0, 1e6);
}

StillWorld compare_causes(const std::vector<Sighting>& sightings, const Eigen::Vector3d& centre_in_object,
                          const StillWorldOptions& options) {
    const auto first = std::find_if(sightings.rbegin(), sightings.rend(), [](const Sighting& s) { return s.moved; });
    const std::size_t begin = first == sightings.rend() ? 0 : sightings.size() - 1 - (first - sightings.rbegin());
    StillWorld world;
    world.sightings = static_cast<int>(sightings.size() - begin);
    if (world.sightings < options.min_sightings) return world;
    Sums sums;
    for (std::size_t k = begin; k < sightings.size(); ++k)
        add(sightings[k], sightings[begin], static_cast<double>(k - begin), centre_in_object, options, sums);
    for (int k = 0; k < kNumCauses; ++k)
        world.evidence.push_back(evidence_of(sums, prior_of(static_cast<Cause>(k), options), sightings.back()));
    const double still = world.evidence[0].log_odds;
    for (CauseEvidence& evidence : world.evidence) evidence.log_odds -= still;
    const auto best = std::max_element(world.evidence.begin(), world.evidence.end(),
                                       [](const auto& a, const auto& b) { return a.log_odds < b.log_odds; });
    if (best->log_odds < options.min_log_odds) return world;
    world.cause = static_cast<Cause>(best - world.evidence.begin());
    for (int k = 0; k < kNumCauses; ++k) {
        const CauseEvidence& evidence = world.evidence[k];
        if (is_set_up(static_cast<Cause>(k)) && evidence.log_odds > best->log_odds - options.as_likely_nats)
            world.error_bound_m = std::max(world.error_bound_m, evidence.shift_m + 1.645 * evidence.sigma_m);
    }
    return world;
}

}  // namespace nearpose
