#include "core/evidence/verdict.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "core/base/check.hpp"
#include "core/base/statistics.hpp"

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

namespace {

double largest_sigma(const Eigen::Matrix3d& covariance) {
    return std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvalues().maxCoeff());
}

// Whether the 90 % regions of rotation and translation lie within the tolerance, without turns about axes of
// revolution.
bool within_tolerance(const Matrix6d& covariance, const Tolerance& tolerance, const Symmetries& symmetries) {
    Eigen::Matrix3d rotation = covariance.topLeftCorner<3, 3>();
    for (const AxisOfRevolution& axis : symmetries.continuous) {
        const Eigen::Matrix3d across =
            Eigen::Matrix3d::Identity() - axis.axis_in_object * axis.axis_in_object.transpose();
        rotation = across * rotation * across.transpose();
    }
    return kNormalRadius3_90 * largest_sigma(rotation) <= tolerance.rotation_rad &&
           kNormalRadius3_90 * largest_sigma(covariance.bottomRightCorner<3, 3>()) <= tolerance.translation_m;
}

}  // namespace

void validate(const VerificationOptions& options) {
    check_option("verification.min_agreement", options.min_agreement, 0.0, 1.0);
    check_option("verification.min_support", options.min_support, 0.0, 1.0);
    check_option("verification.min_overlap", options.min_overlap, 0.0, 1.0);
    check_option("verification.max_coplanar_share", options.max_coplanar_share, 0.0, 1.0);
    check_option("verification.max_alternatives_weight", options.max_alternatives_weight, 0.0, 1.0);
    check_option("verification.contradicted_below", options.contradicted_below, 0.0, 1.0);
    check_option("verification.lost_below", options.lost_below, 0.0, 1.0);
}

bool is_verified(const Evidence& evidence, const VerificationOptions& options) {
    const PixelCost& pixels = evidence.pixels;
    const bool fits = pixels.agreement() >= options.min_agreement && pixels.support() >= options.min_support &&
                      pixels.coplanar_share() <= options.max_coplanar_share && pixels.overlap() >= options.min_overlap;
    return evidence.seen && fits && evidence.alternatives_tried &&
           evidence.alternatives_weight <= options.max_alternatives_weight;
}

Verdict judge(const Evidence& evidence, const Tolerance& tolerance, const Symmetries& symmetries,
              const VerificationOptions& options) {
    if (!evidence.seen || evidence.pixels.agreement() < options.lost_below) return Verdict::kLost;
    const bool sharp = within_tolerance(evidence.covariance_about_centre, tolerance, symmetries);
    return is_verified(evidence, options) && sharp ? Verdict::kAccept : Verdict::kContinue;
}

}  // namespace nearpose
