// In which phase the filter is, and what it may spend on a frame of that phase. Every frame decides anew, by the record
// of the frames before:
//
//    Is nothing known of the pose? Or did the frame before contradict it, or show    yes
//    nothing of it? Or did it agree too little (at first, and then periodically)?  ------> searching
//      | no
//      v                                                                             yes
//    Was it not replaced for some frames, and has no alternative a chance?         ------> tracking
//      | no                                                                                   |
//      v                                                    yes                               |
//    Was it not replaced for some frames?                 --------------------------> comparing
//      | no                                                      the image disagrees with the |
//      v                                                    yes                prediction     v
//    Is it verified, and told from its alternatives?      --------------------------> confirming
//      | no
//      v
//    acquiring
//
// Tracking does not ask whether the pose is verified: a model that is not quite the part never is.
#pragma once

#include <cstdint>
#include <optional>

#include "core/evidence/verdict.hpp"
#include "core/method.hpp"

namespace nearpose {

enum class Phase {
    kSearching,   // global localisation, or relocalisation after a loss
    kAcquiring,   // all particles and alternatives with all rays, until a pose is verified
    kComparing,   // a settled pose with alternatives left: few rays for particles, all rays to compare
    kConfirming,  // a verified pose: all particles and alternatives with fewer rays each
    kTracking,    // a confirmed track: few particles, few rays, alternatives now and then
};

const char* to_string(Phase phase);

// Whether a pose is held and told from its alternatives.
inline bool is_established(Phase phase) {
    return phase == Phase::kConfirming || phase == Phase::kTracking;
}

// The record from which the next frame's phase follows.
struct Lock {
    Phase phase = Phase::kSearching;   // of the last frame that showed enough
    bool verified = false;             // the last estimate passed every test of the verdict but that of its precision
    bool low_agreement = false;        // the last estimate's agreement was too low to be verified
    int alternatives_tried = 0;        // since the tracked mode was last replaced
    double alternatives_weight = 0.0;  // their share of the probability when they were last compared, in 0..1
    int frames_unreplaced = 0;         // in a row, since the tracked mode was last replaced
    int frames_contradicted = 0;       // in a row in which the image contradicts the estimate, or shows nothing of it
    int frames_low_agreement = 0;      // with too little agreement, since the tracked mode was last replaced
    // Evidence of the image for the last accepted pose; it fades from frame to frame, and is 0 where the arm's motion
    // is not known. [nats * squared ray spacing in pixels], which does not depend on how many rays were cast.
    double accepted_evidence = 0.0;
    double log_odds_present = 0.0;  // that the object is there, after the last frame [nats]
};

// Whether the object is to be searched for anew although there is a pose. So it is after a frame that contradicts the
// pose or shows nothing of it. It also is where the agreement is too low, but only in the first such frames of a
// tracked mode, and then periodically: a model that is not quite the part never agrees enough.
bool search_due(const Lock& lock, const Method& method);

// A settled track: not replaced for a while, and not contradicted.
bool settled(const Lock& lock, const Method& method);

// A confirmed track: settled, and told from its alternatives by the images so far.
bool confirmed(const Lock& lock, const Method& method);

// New alternatives are tried in every frame until the track is settled, and then in every so many.
bool alternatives_due(const Lock& lock, const Method& method, std::uint64_t step);

// Whether a frame compares the tracked pose with the alternatives that are known, and with new ones where they are due.
bool compares_alternatives(const Lock& lock, const Method& method, std::uint64_t step);

// The phase of a frame that begins. `has_particles`: something is known of the pose.
Phase phase_of(const Lock& lock, const Method& method, bool has_particles);

// The same after the image was compared with the predicted pose: a track that is not where it should be is confirmed
// anew.
Phase phase_after_prediction(Phase phase, bool image_agrees);

// What a frame of a phase may spend. `predicted`: the image agrees with the predicted pose.
struct Plan {
    GradientStep step;             // of a particle
    RefinementOptions refinement;  // of a mode
    int alternatives = 0;          // tried where they are due
    double search_share = 1.0;     // of a search's hypotheses, in 0..1
};
Plan plan_of(Phase phase, const Method& method, bool predicted);

// The share of a whole search that a frame makes: all of it at first, and a part where nothing was found for long.
double search_share(const Lock& lock, const RelocalisationOptions& options);

// How a frame changes the record, in this order.
//   prediction: evidence fades, since what was accepted may have been moved; all of it where no motion was measured
Lock after_prediction(Lock lock, bool motion_measured, const Method& method);
//   decision on the phase
Lock after_decision(Lock lock, Phase phase);
//   choice of a mode: how many new alternatives were tried, and the weight of all only where they were compared
Lock after_choice(Lock lock, bool replaced, int alternatives_tried, const std::optional<double>& alternatives_weight);
//   the log-odds that the object is there, with the evidence of this frame alone [nats]
double log_odds_with(double frame_log_odds, const Lock& lock, const PresenceOptions& options);
//   assessment; `agreement` is 0 where nothing is seen, `evidence` counts where the pose is accepted
struct Assessment {
    Verdict verdict = Verdict::kLost;
    bool verified = false;
    double agreement = 0.0;
    double evidence = 0.0;
    double log_odds_present = 0.0;  // with the frames before
};
Lock after_assessment(Lock lock, const Assessment& assessment, const Method& method);

}  // namespace nearpose
