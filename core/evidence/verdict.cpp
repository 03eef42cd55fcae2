#include "core/evidence/verdict.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>

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

bool within_tolerance(const Matrix6d& covariance, const Tolerance& tolerance, const Symmetries& symmetries) {
    constexpr double kRadiusOf90Percent = 2.5003;  // of a three-dimensional normal distribution, in sigmas
    Eigen::Matrix3d rotation = covariance.topLeftCorner<3, 3>();
    for (const AxisOfRevolution& axis : symmetries.continuous) {
        const Eigen::Matrix3d across =
            Eigen::Matrix3d::Identity() - axis.axis_in_object * axis.axis_in_object.transpose();
        rotation = across * rotation * across.transpose();
    }
    return kRadiusOf90Percent * largest_sigma(rotation) <= tolerance.rotation_rad &&
           kRadiusOf90Percent * largest_sigma(covariance.bottomRightCorner<3, 3>()) <= tolerance.translation_m;
}

}  // namespace

bool convinces(const Evidence& evidence) {
    constexpr double kMostFlush = 0.4;      // share of the outline where the surface goes on
    constexpr double kLeastOverlap = 0.55;  // of mask and model
    constexpr double kLeastSupport = 0.3;   // share of the model that is seen at all
    const PixelCost& pixels = evidence.pixels;
    const bool fits = pixels.agreement() >= kConvincingAgreement && pixels.support() >= kLeastSupport &&
                      pixels.flush_share() <= kMostFlush && pixels.overlap() >= kLeastOverlap;
    return evidence.seen && fits && evidence.rivals_tried && evidence.rival_weight <= kMostRivalWeight;
}

Verdict judge(const Evidence& evidence, const Tolerance& tolerance, const Symmetries& symmetries) {
    constexpr double kLeastToBelieve = 0.6;  // share of rays that agree
    if (!evidence.seen || evidence.pixels.agreement() < kLeastToBelieve) return Verdict::kLost;
    const bool sharp = within_tolerance(evidence.covariance_about_centre, tolerance, symmetries);
    return convinces(evidence) && sharp ? Verdict::kAccept : Verdict::kContinue;
}

}  // namespace nearpose
