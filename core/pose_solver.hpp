// Port: how a pose is pulled onto the observation, given correspondences (the least squares step of the paper's ICP).
#pragma once

#include "core/base/pose.hpp"
#include "core/correspondences.hpp"

namespace nearpose {

enum class SolveStatus {
    kConverged,    // or the iteration limit was reached with a lower cost
    kTooFewPairs,  // fewer than the minimum: the pose is returned unchanged
    kNotUsable,    // no finite, lower cost was found: the pose is returned unchanged
};

struct SolveResult {
    Pose camera_from_object;
    double initial_cost = 0.0;  // half the sum of robust squared residuals, in units of the residual's variance
    double final_cost = 0.0;
    SolveStatus status = SolveStatus::kConverged;
};

// Implementations are immutable after construction and may be called from several threads at once.
class PoseSolver {
  public:
    virtual ~PoseSolver() = default;

    // Minimises the distance of pairs over camera_from_object, from `camera_from_object` on. Residuals are weighted
    // with the pairs' sigmas. Never throws for data.
    virtual SolveResult solve(const Correspondences& pairs, const Pose& camera_from_object) const = 0;
};

}  // namespace nearpose
