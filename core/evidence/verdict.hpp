// May a robot act on this estimate, and if not, what is missing?
#pragma once

#include <string>
#include <vector>

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
    double log_odds_present = 0.0;                        // that the object is there, with the frames before [nats]
    PixelCost pixels;                                     // at the estimate
    double alternatives_weight = 0.0;                     // share of the probability that other modes have, in 0..1
    bool alternatives_tried = false;                      // since the estimate's mode was last replaced
    std::string alternative;                              // the likeliest of them, in words; empty: not known
    Matrix6d covariance_about_centre = Matrix6d::Zero();  // of the twist in object axes, rotation first
    int frames_since_move = kNeverMoved;                  // since the image last contradicted the arm's motion
    double motion_off_share = 0.0;  // of the arm's motion, where a mistake in it explains the images; else 0
    std::string motion_mistake;     // in words
    double setup_error_m = 0.0;     // that the set-up may cause, where the part seems to move by it
    std::string setup_cause;        // in words

    static constexpr int kNeverMoved = 1 << 20;
};

// Bounds between verified, contradicted and lost. All are shares in 0..1; agreement, support, overlap and coplanar
// share are those of PixelCost.
struct VerificationOptions {
    // To be verified, a pose must pass all of these.
    double min_log_odds_present = 5.0;  // of the object against planes alone, see background.hpp [nats]
    double min_agreement = 0.93;
    double min_support = 0.3;  // the part must be seen at all
    double min_overlap = 0.55;
    double max_coplanar_share = 0.4;
    double max_alternatives_weight = 0.01;  // of the probability
    // In the agreement, residuals may be larger than the noise by so many of what the joint fit finds neighbouring rays
    // to be off together. Without it 30 instead of 100 % of a real sequence with a rough CAD are accepted.
    double shared_errors_allowed = 1.0;
    // Frames before a part that was moved, or a set-up that has changed, is believed to stand.
    int min_frames_since_move = 5;
    double max_motion_off_share = 0.1;  // of the arm's motion by a mistake in it
    // Agreement below which the image contradicts the pose, so that the object is searched for anew.
    double contradicted_below = 0.8;
    // Below one of these the pose is lost.
    double lost_below = 0.6;                 // agreement
    double lost_below_log_odds = -2.197225;  // of a probability of 0.1 that the object is there [nats]
};

// Throws std::invalid_argument naming field, value and bound.
void validate(const VerificationOptions& options);

// What a pose must have to be accepted.
enum class Requirement {
    kSeen,               // the object was found in this frame
    kPresence,           // the image shows relief and steps of the model, which planes do not explain [nats]
    kAgreement,          // little contradicts the pose: PixelCost::agreement
    kSupport,            // enough of the model is seen: PixelCost::support
    kOutline,            // the part ends where the model does: PixelCost::coplanar_share
    kOverlap,            // mask and model cover each other: PixelCost::overlap
    kAlternativesTried,  // the pose was compared with those that look alike
    kAlternatives,       // none of them explains the image nearly as well: their share of the probability
    kNewImage,           // the image is not the one before
    kStands,             // the part was not moved just now, by what image and arm say together
    kArmMotion,          // the images move as the arm says
    kSetup,              // the part does not seem to move by an error of the set-up [m]
    kTranslation,        // 90 % of the probability lies within the tolerance [m]
    kRotation,           // the same [rad]
};

const char* to_string(Requirement requirement);

// A requirement that is not met.
struct Shortfall {
    Requirement requirement = Requirement::kSeen;
    double value = 0.0;  // in the requirement's unit
    double limit = 0.0;
    std::string which;  // the axis that is known worst, or the alternative
};

// In words, with figure and limit: "precision: 2.6 mm along x, wanted 2.0 mm".
std::string describe(const Shortfall& shortfall);

struct Judgement {
    Verdict verdict = Verdict::kLost;
    bool verified = false;           // the image confirms the pose: only precision or the set-up may be missing
    std::vector<Shortfall> missing;  // empty: accepted
};

// From the present frame's evidence alone:
//   lost      nothing is seen of the object, it is probably not there, or the image contradicts the pose
//   accept    every requirement is met
//   continue  otherwise
// Rotation about an axis of revolution, which no image can show, does not count.
Judgement judge(const Evidence& evidence, const Tolerance& tolerance, const Symmetries& symmetries,
                const VerificationOptions& options = {});

}  // namespace nearpose
