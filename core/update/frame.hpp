// One observation under work: what it is given, and what its update measured and spent. Nothing of it survives.
#pragma once

#include <chrono>
#include <cstdint>
#include <list>
#include <optional>

#include "core/filter/gradient_step.hpp"
#include "core/observation/observation.hpp"
#include "core/options.hpp"
#include "core/pose_solver.hpp"
#include "core/result.hpp"
#include "core/update/object_model.hpp"
#include "core/update/time_budget.hpp"

namespace nearpose {

// What all stages of an update read. Refers to what it is given: it must not outlive the call of `update`.
struct Frame {
    const ObjectModel& model;
    const PoseSolver& solver;
    const EstimatorOptions& options;
    const Observation& observation;
    std::optional<Pose> now_from_before;  // the camera's measured motion, valid; nothing where none was measured
    std::uint64_t step = 0;               // addresses the random streams

    const Method& method() const { return options.method; }
    bool shows_enough() const { return observation.num_candidates() >= options.min_candidates; }
    // What all particles or modes on one ray grid share.
    StepContext context(const ObservedGrid& observed, const GradientStep& gradient_step) const;
};

// Elapsed time since it was made.
class Stopwatch {
  public:
    double elapsed_s() const {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - began_).count();
    }

  private:
    std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
};

// What an update has measured and spent so far.
class Ledger {
  public:
    explicit Ledger(const TimeBudget& before) : budget(before) {}

    // So many of `wanted` units of a stage fit into the budget, never less than `least`.
    int affordable(Stage stage, int wanted, int least);
    // Counts and times of the particles' steps.
    void add(const StepCounts& step_counts, const StageSeconds& stage_seconds);
    double elapsed_s() const { return watch_.elapsed_s(); }
    // The measurement on a ray grid, made when first asked for; the reference holds as long as the ledger.
    const ObservedGrid& measured(const PixelGrid& grid, const Observation& observation);

    // Writes effort, counts and times into the result, and gives what the budget learned of this update.
    TimeBudget close(UpdateResult& result) const;

    TimeBudget budget;
    Effort effort;
    StepCounts counts;
    UpdateSeconds seconds;
    bool resampled = false;

  private:
    Stopwatch watch_;
    std::list<ObservedGrid> grids_;
};

}  // namespace nearpose
