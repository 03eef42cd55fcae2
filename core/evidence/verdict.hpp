// May a robot act on this estimate?
#pragma once

#include "core/base/pose.hpp"
#include "core/evidence/likelihood.hpp"
#include "core/shape/symmetry.hpp"

namespace nearpose {

enum class Verdict {
    kAccept,    // the pose is right, and known to within the tolerance
    kContinue,  // it may be right: look again, from nearer or elsewhere
    kLost,      // no pose explains what is seen
};

const char* to_string(Verdict verdict);

// Within which the pose must be known to be accepted: at the centre of the model's box, 90 % of the probability.
struct Tolerance {
    double translation_m = 0.002;
    double rotation_rad = 0.0174532925199432958;  // 1 degree
};

// What the present frame says about an estimate.
struct Evidence {
    bool seen = false;                                    // the object was found in this frame
    PixelCost pixels;                                     // at the estimate
    double alternatives_weight = 0.0;                     // share of the probability that other modes have
    bool alternatives_tried = false;                      // other modes were looked for since the estimate came up
    Matrix6d covariance_about_centre = Matrix6d::Zero();  // rotation first
};

// What a pose must pass to be verified, and what it may fail before it is lost. All are shares in 0..1.
struct VerificationOptions {
    double min_agreement = 0.93;            // of the rays that say anything about the object, those that agree
    double min_support = 0.3;               // of the model's rays, those that agree: it must be seen at all
    double min_overlap = 0.55;              // of mask and model
    double max_coplanar_share = 0.4;        // of the outline, where the surface goes on beyond it
    double max_alternatives_weight = 0.01;  // of the probability, what other modes may have
    double contradicted_below = 0.8;        // agreement under which the image contradicts the pose: search anew
    double lost_below = 0.6;                // agreement under which the pose is lost
};

// Throws std::invalid_argument naming field, value and bound.
void validate(const VerificationOptions& options);

// Whether the depth agrees with the pose wherever it says anything, the part ends where the model does, and no other
// mode explains the image nearly as well: the right pose, how ever precisely it is known.
bool is_verified(const Evidence& evidence, const VerificationOptions& options = {});

// From present evidence alone:
//   lost      nothing is seen of the object, or what is seen contradicts the pose
//   accept    it is verified, and the 90 % region lies within the tolerance
//   continue  else
// What a turn about an axis of revolution leaves open does not count.
Verdict judge(const Evidence& evidence, const Tolerance& tolerance, const Symmetries& symmetries,
              const VerificationOptions& options = {});

}  // namespace nearpose
