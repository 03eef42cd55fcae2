#include "core/update/refine.hpp"

#include "core/base/parallel.hpp"
#include "core/update/ray_grids.hpp"

namespace nearpose {

Mode mode_of(const RefinedMode& refined) {
    return {refined.camera_from_object, refined.cost, refined.support, refined.log_evidence};
}

std::vector<Mode> refine(const std::vector<Mode>& modes, const Situation& situation, const Frame& frame,
                         Ledger& ledger) {
    const RefinementOptions& refinement = situation.plan.refinement;
    const PixelGrid grid = ray_grid(frame, situation.window.around, refinement.max_rays);
    const StepContext context = frame.context(ledger.measured(grid, frame.observation), frame.method().step);
    const Stopwatch watch;
    const int count = static_cast<int>(modes.size());
    std::vector<RefinedMode> moved(modes.size());
    if (situation.prediction && count == 1) {
        moved[0] = *situation.prediction;
    } else {
        parallel_for(count, frame.options.num_threads,
                     [&](int k) { moved[k] = refine_mode(modes[k].camera_from_object, context, refinement); });
    }
    ledger.effort.modes += count;
    ledger.budget.took(Stage::kModes, count, watch.elapsed_s());
    std::vector<Mode> refined;
    for (const RefinedMode& mode : moved) {
        refined.push_back(mode_of(mode));
        ledger.add(mode.counts, mode.seconds);
    }
    return refined;
}

RefinedMode evaluate_prediction(const Pose& predicted, const Situation& situation, const Frame& frame, Ledger& ledger) {
    RefinementOptions unmoved = situation.plan.refinement;
    unmoved.rounds = 0;
    const PixelGrid grid = ray_grid(frame, situation.window.around, unmoved.max_rays);
    const StepContext context = frame.context(ledger.measured(grid, frame.observation), frame.method().step);
    return refine_mode(predicted, context, unmoved);
}

Situation gate_prediction(Situation situation, const Belief& predicted, const Frame& frame, Ledger& ledger) {
    if (!is_established(situation.phase) || !(predicted.lock.accepted_evidence > 0.0)) return situation;
    const RefinedMode prediction = evaluate_prediction(predicted.tracked->camera_from_object, situation, frame, ledger);
    const bool agrees = prediction.inlier_ratio >= frame.method().verification.min_agreement;
    if (agrees) situation.prediction = prediction;
    situation.phase = phase_after_prediction(situation.phase, agrees);
    situation.plan = plan_of(situation.phase, frame.method(), agrees);
    return situation;
}

}  // namespace nearpose
