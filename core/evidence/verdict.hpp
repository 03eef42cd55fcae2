// May a robot act on this estimate?
#pragma once

#include "core/base/pose.hpp"
#include "core/evidence/likelihood.hpp"
#include "core/shape/symmetry.hpp"

namespace nearpose {

enum class Verdict {
    kAccept,    // the pose is right, and known to within the tolerance
    kContinue,  // it may be right, but not surely or not precisely enough: look again, from nearer or elsewhere
    kLost,      // no pose explains what is seen
};

const char* to_string(Verdict verdict);

// How precisely a pose must be known to be accepted: 90 % of the probability lies within, at the centre of the model's
// box.
struct Tolerance {
    double translation_m = 0.002;
    double rotation_rad = 0.0174532925199432958;  // 1 degree
};

// What the present frame says about an estimate.
struct Evidence {
    bool seen = false;                                    // the object was found in this frame
    PixelCost pixels;                                     // at the estimate
    double alternatives_weight = 0.0;                     // share of the probability that other modes have, in 0..1
    bool alternatives_tried = false;                      // since the estimate's mode was last replaced
    Matrix6d covariance_about_centre = Matrix6d::Zero();  // of the twist in object axes, rotation first
};

// Bounds between verified, contradicted and lost. All are shares in 0..1; agreement, support, overlap and coplanar
// share are those of PixelCost.
struct VerificationOptions {
    // To be verified, a pose must pass all of these.
    double min_agreement = 0.93;
    double min_support = 0.3;  // the part must be seen at all
    double min_overlap = 0.55;
    double max_coplanar_share = 0.4;
    double max_alternatives_weight = 0.01;  // of the probability
    // Agreement below which the image contradicts the pose, so that the object is searched for anew.
    double contradicted_below = 0.8;
    // Agreement below which the pose is lost.
    double lost_below = 0.6;
};

// Throws std::invalid_argument naming field, value and bound.
void validate(const VerificationOptions& options);

// Hypothesis verification: the depth agrees with the pose, the part ends where the model does, and no alternative
// explains the image nearly as well. It says nothing about how precisely the pose is known.
bool is_verified(const Evidence& evidence, const VerificationOptions& options = {});

// From the present frame's evidence alone:
//   lost      nothing is seen of the object, or the image contradicts the pose (agreement below `lost_below`)
//   accept    the pose is verified, and its 90 % region lies within the tolerance
//   continue  otherwise
// Rotation about an axis of revolution, which no image can show, does not count.
Verdict judge(const Evidence& evidence, const Tolerance& tolerance, const Symmetries& symmetries,
              const VerificationOptions& options = {});

}  // namespace nearpose
