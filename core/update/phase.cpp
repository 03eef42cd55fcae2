#include "core/update/phase.hpp"

#include <algorithm>

namespace nearpose {

const char* to_string(Phase phase) {
    switch (phase) {
        case Phase::kSearching:
            return "searching";
        case Phase::kAcquiring:
            return "acquiring";
        case Phase::kComparing:
            return "comparing";
        case Phase::kConfirming:
            return "confirming";
        case Phase::kTracking:
            return "tracking";
    }
    return "";
}

bool search_due(const Lock& lock, const Method& method) {
    const RelocalisationOptions& options = method.relocalisation;
    if (method.hypotheses.modes == 0 || options.frames_contradicted == 0) return false;
    if (lock.frames_contradicted > 0) return lock.frames_contradicted % options.frames_contradicted == 0;
    return lock.low_agreement && (lock.frames_low_agreement <= options.low_agreement_at_first ||
                                  lock.frames_low_agreement % options.low_agreement_period == 0);
}

bool settled(const Lock& lock, const Method& method) {
    return lock.frames_unreplaced >= method.effort.frames_to_confirm && lock.frames_contradicted == 0;
}

bool confirmed(const Lock& lock, const Method& method) {
    return settled(lock, method) && lock.alternatives_weight <= method.verification.max_alternatives_weight;
}

bool alternatives_due(const Lock& lock, const Method& method, std::uint64_t step) {
    return !settled(lock, method) || step % static_cast<std::uint64_t>(method.hypotheses.alternatives_period) == 0;
}

bool compares_alternatives(const Lock& lock, const Method& method, std::uint64_t step) {
    return !confirmed(lock, method) || alternatives_due(lock, method, step);
}

Phase phase_of(const Lock& lock, const Method& method, bool has_particles) {
    if (!has_particles || search_due(lock, method)) return Phase::kSearching;
    if (!method.effort.on) return Phase::kAcquiring;
    if (confirmed(lock, method)) return Phase::kTracking;
    if (settled(lock, method)) return Phase::kComparing;
    return lock.verified ? Phase::kConfirming : Phase::kAcquiring;
}

Phase phase_after_prediction(Phase phase, bool image_agrees) {
    return phase == Phase::kTracking && !image_agrees ? Phase::kConfirming : phase;
}

namespace {

// None where the method's own numbers hold.
const PhaseEffort* effort_of(Phase phase, const AdaptiveEffort& effort) {
    if (phase == Phase::kComparing) return &effort.comparing;
    if (phase == Phase::kConfirming) return &effort.confirming;
    return phase == Phase::kTracking ? &effort.tracking : nullptr;
}

}  // namespace

Plan plan_of(Phase phase, const Method& method, bool predicted) {
    Plan plan{method.step, method.refinement, method.hypotheses.alternatives};
    if (const PhaseEffort* found = effort_of(phase, method.effort)) {
        const PhaseEffort& effort = *found;
        plan.step.max_rays = std::min(plan.step.max_rays, effort.particle_rays);
        plan.refinement.max_rays = std::min(plan.refinement.max_rays, effort.mode_rays);
        plan.refinement.rounds = std::min(plan.refinement.rounds, effort.mode_rounds);
        plan.alternatives = std::min(plan.alternatives, effort.alternatives);
    }
    if (predicted) plan.step.rounds = std::min(plan.step.rounds, method.effort.predicted_rounds);
    return plan;
}

double search_share(const Lock& lock, const RelocalisationOptions& options) {
    return lock.frames_contradicted < options.whole_searches ? 1.0 : 1.0 / options.parts_of_search;
}

Lock after_prediction(Lock lock, bool motion_measured, const Method& method) {
    lock.accepted_evidence *= motion_measured ? method.choice.accepted_evidence_kept : 0.0;
    lock.log_odds_present *= motion_measured ? method.presence.kept : method.presence.kept_unmeasured;
    return lock;
}

Lock after_decision(Lock lock, Phase phase) {
    lock.phase = phase;
    return lock;
}

Lock after_choice(Lock lock, bool replaced, int alternatives_tried, const std::optional<double>& alternatives_weight) {
    if (replaced) {
        lock.alternatives_tried = 0;
        // The evidence was for another pose.
        lock.log_odds_present = 0.0;
        lock.accepted_evidence = 0.0;
        lock.frames_low_agreement = 0;
    }
    lock.alternatives_tried += alternatives_tried;
    lock.frames_unreplaced = replaced ? 0 : lock.frames_unreplaced + 1;
    if (alternatives_weight) lock.alternatives_weight = *alternatives_weight;
    return lock;
}

double log_odds_with(double frame_log_odds, const Lock& lock, const PresenceOptions& options) {
    return std::clamp(lock.log_odds_present + frame_log_odds, -options.max_log_odds, options.max_log_odds);
}

Lock after_assessment(Lock lock, const Assessment& assessment, const Method& method) {
    const VerificationOptions& limits = method.verification;
    const bool accepted = assessment.verdict == Verdict::kAccept;
    lock.verified = assessment.verified;
    lock.log_odds_present = assessment.log_odds_present;
    lock.frames_contradicted = assessment.agreement < limits.contradicted_below ? lock.frames_contradicted + 1 : 0;
    lock.low_agreement = method.relocalisation.low_agreement && assessment.agreement < limits.min_agreement;
    lock.frames_low_agreement += lock.low_agreement;
    if (accepted && method.choice.accepted_evidence)
        lock.accepted_evidence = std::max(lock.accepted_evidence, assessment.evidence);
    return lock;
}

}  // namespace nearpose
