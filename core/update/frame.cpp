#include "core/update/frame.hpp"

#include <algorithm>

namespace nearpose {

StepContext Frame::context(const ObservedGrid& observed, const GradientStep& gradient_step) const {
    const double diameter_m = model.diameter_m();
    PixelCostOptions pixel_cost = method().pixel_cost;
    pixel_cost.extra_sigma_m = gradient_step.extra_sigma_diameters * diameter_m;
    pixel_cost.free_space_depth_m = method().free_space_depth_diameters * diameter_m;
    return {*model.views,  solver,        observation, observed,
            gradient_step, method().cost, pixel_cost,  method().scale_by_overlap};
}

int Ledger::affordable(Stage stage, int wanted, int least) {
    const int count = budget.affordable(stage, wanted, least, elapsed_s());
    if (count < wanted) effort.reduced_for_budget = true;
    return count;
}

void Ledger::add(const StepCounts& step_counts, const StageSeconds& stage_seconds) {
    counts += step_counts;
    seconds.stages += stage_seconds;
}

const ObservedGrid& Ledger::measured(const PixelGrid& grid, const Observation& observation) {
    auto kept =
        std::find_if(grids_.begin(), grids_.end(), [&](const ObservedGrid& other) { return other.grid == grid; });
    if (kept == grids_.end()) kept = grids_.insert(grids_.end(), observe(observation, grid));
    return *kept;
}

TimeBudget Ledger::close(UpdateResult& result) const {
    result.effort = effort;
    result.counts = counts;
    result.resampled = resampled;
    result.seconds = seconds;
    result.seconds.total = elapsed_s();
    TimeBudget learned = budget;
    learned.took(Stage::kFit, 1, result.seconds.total - seconds.start - seconds.particles - seconds.refinement);
    return learned;
}

}  // namespace nearpose
