#include "core/evidence/verdict.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "core/base/check.hpp"
#include "core/base/statistics.hpp"
#include "core/base/text.hpp"
#include "core/evidence/observability.hpp"

namespace nearpose {

const char* to_string(Verdict verdict) {
    switch (verdict) {
        case Verdict::kAccept:
            return "accept";
        case Verdict::kContinue:
            return "continue";
        case Verdict::kLost:
            return "lost";
    }
    return "";
}

const char* to_string(Requirement requirement) {
    switch (requirement) {
        case Requirement::kSeen:
            return "seen";
        case Requirement::kPresence:
            return "presence";
        case Requirement::kAgreement:
            return "agreement";
        case Requirement::kSupport:
            return "support";
        case Requirement::kOutline:
            return "outline";
        case Requirement::kOverlap:
            return "overlap";
        case Requirement::kAlternativesTried:
            return "alternatives_tried";
        case Requirement::kAlternatives:
            return "alternatives";
        case Requirement::kNewImage:
            return "new_image";
        case Requirement::kStands:
            return "stands";
        case Requirement::kArmMotion:
            return "arm_motion";
        case Requirement::kSetup:
            return "setup";
        case Requirement::kTranslation:
            return "translation";
        case Requirement::kRotation:
            return "rotation";
    }
    return "";
}

namespace {

// Decimals that tell the figure from its limit and give the limit to a hundredth of itself; `usual` or up to three
// more.
int decimals_for(double value, double limit, int usual) {
    for (int decimals = usual; decimals < usual + 3; ++decimals) {
        const double shown = std::round(limit * std::pow(10.0, decimals)) / std::pow(10.0, decimals);
        const bool told = std::abs(shown - limit) <= 0.01 * std::abs(limit);
        if (told && fixed_text(value, decimals) != fixed_text(limit, decimals)) return decimals;
    }
    return usual + 3;
}

// "0.93", with its unit.
std::string figure_of(const Shortfall& shortfall, double unit, int usual_decimals, const char* name) {
    return fixed_text(unit * shortfall.value,
                      decimals_for(unit * shortfall.value, unit * shortfall.limit, usual_decimals)) +
           name;
}

// ", wanted 0.93", with its unit.
std::string wanted_of(const Shortfall& shortfall, double unit, int usual_decimals, const char* name) {
    return ", wanted " +
           fixed_text(unit * shortfall.limit,
                      decimals_for(unit * shortfall.value, unit * shortfall.limit, usual_decimals)) +
           name;
}

constexpr double kMillimetres = 1e3, kDegrees = 57.295779513082321;

// What image and arm together say against the pose.
std::string describe_contradiction(const Shortfall& shortfall) {
    if (shortfall.requirement == Requirement::kNewImage)
        return "the image has not changed for " + figure_of(shortfall, 1.0, 0, " frames") +
               (shortfall.which.empty() ? "" : " while the camera moved by " + shortfall.which);
    if (shortfall.requirement == Requirement::kStands)
        return "image and arm contradict each other: the part was moved, or the set-up is at fault; " +
               figure_of(shortfall, 1.0, 0, " frames ago") + wanted_of(shortfall, 1.0, 0, "");
    if (shortfall.requirement == Requirement::kArmMotion)
        return "the image moves " + shortfall.which + ": the arm's motion is off by " +
               figure_of(shortfall, 1.0, 2, " of itself") + wanted_of(shortfall, 1.0, 2, " at most");
    return "the part seems to move with the camera, by the " + shortfall.which + ": up to " +
           figure_of(shortfall, kMillimetres, 1, " mm here") + wanted_of(shortfall, kMillimetres, 1, " mm at most");
}

}  // namespace

std::string describe(const Shortfall& shortfall) {
    const auto figures = [&](double unit, int decimals, const char* name) {
        return figure_of(shortfall, unit, decimals, name);
    };
    const auto wanted = [&](double unit, int decimals, const char* name) {
        return wanted_of(shortfall, unit, decimals, name);
    };
    switch (shortfall.requirement) {
        case Requirement::kSeen:
            return "nothing of the object was found";
        case Requirement::kPresence:
            return "the image hardly shows more than planes: " + figures(1.0, 1, " nats") + wanted(1.0, 1, "");
        case Requirement::kAgreement:
            return "too little agrees: " + figures(1.0, 2, "") + wanted(1.0, 2, "");
        case Requirement::kSupport:
            return "too little of the model is seen: " + figures(1.0, 2, "") + wanted(1.0, 2, "");
        case Requirement::kOutline:
            return "surfaces go on where the model ends: " + figures(1.0, 2, " of its outline") +
                   wanted(1.0, 2, " at most");
        case Requirement::kOverlap:
            return "mask and model do not cover each other: " + figures(1.0, 2, "") + wanted(1.0, 2, "");
        case Requirement::kAlternativesTried:
            return "not yet compared with poses that look alike";
        case Requirement::kAlternatives:
            return "another pose explains the image as well: " +
                   (shortfall.which.empty() ? "" : shortfall.which + ", ") + figures(1.0, 2, " of the probability") +
                   wanted(1.0, 2, " at most");
        case Requirement::kNewImage:
        case Requirement::kStands:
        case Requirement::kArmMotion:
        case Requirement::kSetup:
            return describe_contradiction(shortfall);
        case Requirement::kTranslation:
            return "precision: " + figures(kMillimetres, 1, " mm along ") + shortfall.which +
                   wanted(kMillimetres, 1, " mm");
        case Requirement::kRotation:
            return "precision: " + figures(kDegrees, 2, " degrees about ") + shortfall.which +
                   wanted(kDegrees, 2, " degrees");
    }
    return "";
}

namespace {

// The direction that is known worst, and the radius of the 90 % region along it.
struct Spread {
    double radius = 0.0;
    std::string axis;
};

Spread largest_spread(const Eigen::Matrix3d& covariance) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);  // ascending
    return {kNormalRadius3_90 * std::sqrt(std::max(0.0, solver.eigenvalues()[2])),
            axis_name(solver.eigenvectors().col(2))};
}

// Without turns about axes of revolution.
Eigen::Matrix3d rotation_that_shows(const Matrix6d& covariance, const Symmetries& symmetries) {
    Eigen::Matrix3d rotation = covariance.topLeftCorner<3, 3>();
    for (const AxisOfRevolution& axis : symmetries.continuous) {
        const Eigen::Matrix3d across =
            Eigen::Matrix3d::Identity() - axis.axis_in_object * axis.axis_in_object.transpose();
        rotation = across * rotation * across.transpose();
    }
    return rotation;
}

// All that keeps a pose from being verified.
std::vector<Shortfall> missing_to_verify(const Evidence& evidence, const VerificationOptions& options) {
    std::vector<Shortfall> missing;
    const auto at_least = [&](Requirement requirement, double value, double limit) {
        if (!(value >= limit)) missing.push_back({requirement, value, limit, {}});
    };
    const auto at_most = [&](Requirement requirement, double value, double limit, const std::string& which) {
        if (!(value <= limit)) missing.push_back({requirement, value, limit, which});
    };
    const PixelCost& pixels = evidence.pixels;
    at_least(Requirement::kSeen, evidence.seen, 1.0);
    if (!evidence.seen) return missing;
    at_least(Requirement::kPresence, evidence.log_odds_present, options.min_log_odds_present);
    at_least(Requirement::kAgreement, pixels.agreement(), options.min_agreement);
    at_least(Requirement::kSupport, pixels.support(), options.min_support);
    at_most(Requirement::kOutline, pixels.coplanar_share(), options.max_coplanar_share, {});
    at_least(Requirement::kOverlap, pixels.overlap(), options.min_overlap);
    at_least(Requirement::kAlternativesTried, evidence.alternatives_tried, 1.0);
    at_most(Requirement::kAlternatives, evidence.alternatives_weight, options.max_alternatives_weight,
            evidence.alternative);
    return missing;
}

// What image and arm together say against acting on the pose. It is no evidence against the pose in the image.
std::vector<Shortfall> contradictions_to_arm(const Evidence& evidence, const Tolerance& tolerance,
                                             const VerificationOptions& options) {
    std::vector<Shortfall> missing;
    if (evidence.frames_since_move < options.min_frames_since_move)
        missing.push_back({Requirement::kStands,
                           static_cast<double>(evidence.frames_since_move),
                           static_cast<double>(options.min_frames_since_move),
                           {}});
    if (!(evidence.motion_off_share <= options.max_motion_off_share))
        missing.push_back({Requirement::kArmMotion, evidence.motion_off_share, options.max_motion_off_share,
                           evidence.motion_mistake});
    if (!(evidence.setup_error_m <= tolerance.translation_m))
        missing.push_back({Requirement::kSetup, evidence.setup_error_m, tolerance.translation_m, evidence.setup_cause});
    return missing;
}

}  // namespace

void validate(const VerificationOptions& options) {
    check_option("verification.min_log_odds_present", options.min_log_odds_present, -1e9, 1e9);
    check_option("verification.lost_below_log_odds", options.lost_below_log_odds, -1e9, 1e9);
    check_option("verification.min_agreement", options.min_agreement, 0.0, 1.0);
    check_option("verification.min_support", options.min_support, 0.0, 1.0);
    check_option("verification.min_overlap", options.min_overlap, 0.0, 1.0);
    check_option("verification.max_coplanar_share", options.max_coplanar_share, 0.0, 1.0);
    check_option("verification.max_alternatives_weight", options.max_alternatives_weight, 0.0, 1.0);
    check_option("verification.shared_errors_allowed", options.shared_errors_allowed, 0.0, 100.0);
    check_option("verification.min_frames_since_move", options.min_frames_since_move, 0, 1000);
    check_option("verification.max_motion_off_share", options.max_motion_off_share, 0.0, 1e6);
    check_option("verification.contradicted_below", options.contradicted_below, 0.0, 1.0);
    check_option("verification.lost_below", options.lost_below, 0.0, 1.0);
}

Judgement judge(const Evidence& evidence, const Tolerance& tolerance, const Symmetries& symmetries,
                const VerificationOptions& options) {
    Judgement judgement;
    judgement.missing = missing_to_verify(evidence, options);
    judgement.verified = judgement.missing.empty();
    if (!evidence.seen || evidence.pixels.agreement() < options.lost_below ||
        evidence.log_odds_present < options.lost_below_log_odds)
        return judgement;
    const Matrix6d& covariance = evidence.covariance_about_centre;
    const std::vector<Shortfall> contradictions = contradictions_to_arm(evidence, tolerance, options);
    judgement.missing.insert(judgement.missing.end(), contradictions.begin(), contradictions.end());
    const Spread slide = largest_spread(covariance.bottomRightCorner<3, 3>());
    const Spread turn = largest_spread(rotation_that_shows(covariance, symmetries));
    if (!(slide.radius <= tolerance.translation_m))
        judgement.missing.push_back({Requirement::kTranslation, slide.radius, tolerance.translation_m, slide.axis});
    if (!(turn.radius <= tolerance.rotation_rad))
        judgement.missing.push_back({Requirement::kRotation, turn.radius, tolerance.rotation_rad, turn.axis});
    judgement.verdict = judgement.missing.empty() ? Verdict::kAccept : Verdict::kContinue;
    return judgement;
}

}  // namespace nearpose
