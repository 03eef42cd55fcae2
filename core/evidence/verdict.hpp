// May a robot act on this estimate?
#pragma once

#include "core/evidence/likelihood.hpp"
#include "core/base/pose.hpp"
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
    double rival_weight = 0.0;                            // share of the probability that other modes have
    bool rivals_tried = false;                            // other modes were looked for since the estimate came up
    Matrix6d covariance_about_centre = Matrix6d::Zero();  // rotation first
};

// Share of the rays that agree, of those that say anything about the object: less does not convince.
inline constexpr double kConvincingAgreement = 0.93;
// Share of the probability that other modes may have.
inline constexpr double kMostRivalWeight = 0.01;

// Whether the depth agrees with the pose wherever it says anything, the part ends where the model does, and no other
// mode explains the image nearly as well: the right pose, how ever precisely it is known.
bool convinces(const Evidence& evidence);

// From present evidence alone:
//   lost      nothing is seen of the object, or what is seen contradicts the pose
//   accept    it convinces, and the 90 % region lies within the tolerance
//   continue  else
// What a turn about an axis of revolution leaves open does not count.
Verdict judge(const Evidence& evidence, const Tolerance& tolerance, const Symmetries& symmetries);

}  // namespace nearpose
