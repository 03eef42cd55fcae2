#include "core/update/phase.hpp"

#include <algorithm>
#include <cmath>

namespace nearpose {

const char* to_string(Phase phase) {
    switch (phase) {
        case Phase::kSearching:
            return "searching";
        case Phase::kAcquiring:
            return "acquiring";
        case Phase::kConfirming:
            return "confirming";
        case Phase::kTracking:
            return "tracking";
    }
    return "";
}

bool search_due(const Lock& lock, const Refinement& refinement) {
    constexpr int kAtFirst = 4, kPeriod = 16;  // frames
    const int period = refinement.frames_to_search;
    if (refinement.modes == 0 || period == 0) return false;
    if (lock.frames_contradicted > 0) return lock.frames_contradicted % period == 0;
    return lock.agrees_too_little && (lock.frames_unverified <= kAtFirst || lock.frames_unverified % kPeriod == 0);
}

bool confirmed(const Lock& lock, const Refinement& refinement) {
    return lock.frames_unreplaced >= refinement.frames_to_hold && lock.alternatives_weight < kMostRivalWeight &&
           lock.frames_contradicted == 0;
}

bool alternatives_due(const Lock& lock, const Refinement& refinement, std::uint64_t step) {
    return !confirmed(lock, refinement) || step % static_cast<std::uint64_t>(refinement.rival_period) == 0;
}

Phase phase_of(const Lock& lock, const Method& method, bool has_particles) {
    if (!has_particles || search_due(lock, method.refinement)) return Phase::kSearching;
    if (!method.economy.on) return Phase::kAcquiring;
    if (confirmed(lock, method.refinement)) return Phase::kTracking;
    // With a third of the rays the alternatives are told apart by a third of the evidence.
    const double rays_before = plan_of(lock.phase, method, false).refinement.max_rays;
    const double share = std::min(1.0, method.economy.confirming_rays / rays_before);
    const bool told_apart = std::pow(lock.alternatives_weight, share) <= kMostRivalWeight;
    return lock.verified && told_apart ? Phase::kConfirming : Phase::kAcquiring;
}

Phase phase_after_prediction(Phase phase, bool image_agrees) {
    return phase == Phase::kTracking && !image_agrees ? Phase::kConfirming : phase;
}

Plan plan_of(Phase phase, const Method& method, bool predicted) {
    const Economy& economy = method.economy;
    Plan plan{method.step, method.refinement};
    if (phase == Phase::kConfirming || phase == Phase::kTracking)
        plan.step.max_rays = std::min(plan.step.max_rays, economy.step_rays);
    if (predicted) plan.step.rounds = std::min(plan.step.rounds, economy.step_rounds);
    if (phase == Phase::kConfirming) {
        plan.refinement.max_rays = std::min(plan.refinement.max_rays, economy.confirming_rays);
        plan.refinement.rounds = std::min(plan.refinement.rounds, economy.confirming_rounds);
    }
    if (phase == Phase::kTracking) {
        plan.refinement.max_rays = std::min(plan.refinement.max_rays, economy.rays);
        plan.refinement.rounds = std::min(plan.refinement.rounds, economy.rounds);
        plan.refinement.rivals = std::min(plan.refinement.rivals, economy.rivals);
    }
    return plan;
}

Lock after_prediction(Lock lock, bool motion_measured) {
    constexpr double kKept = 0.7;  // a frame
    lock.accepted_evidence *= motion_measured ? kKept : 0.0;
    return lock;
}

Lock after_choice(Lock lock, bool replaced, const std::optional<double>& alternatives_weight) {
    if (replaced) lock.alternatives_tried = false;
    lock.frames_unreplaced = replaced ? 0 : lock.frames_unreplaced + 1;
    if (alternatives_weight) {
        lock.alternatives_tried = true;
        lock.alternatives_weight = *alternatives_weight;
    }
    return lock;
}

Lock after_assessment(Lock lock, const Assessment& assessment, const Refinement& refinement) {
    constexpr double kContradicted = 0.8;
    const bool accepted = assessment.verdict == Verdict::kAccept;
    lock.verified = assessment.verified;
    lock.frames_contradicted = assessment.agreement < kContradicted ? lock.frames_contradicted + 1 : 0;
    if (accepted) lock.frames_unverified = 0;
    lock.agrees_too_little = refinement.doubts && assessment.agreement < kConvincingAgreement;
    lock.frames_unverified += lock.agrees_too_little;
    if (accepted && refinement.confidence)
        lock.accepted_evidence = std::max(lock.accepted_evidence, assessment.evidence);
    return lock;
}

}  // namespace nearpose
