// The baseline of the gradient step: point-to-point least squares in closed form (Kabsch, Umeyama).
#pragma once

#include "core/base/pose.hpp"
#include "core/correspondences.hpp"
#include "core/pose_solver.hpp"

namespace nearpose {

// Minimises the sum of |camera_from_object * p - q|^2 / sigma^2 over all poses; it knows no robust loss, and the pose
// given to solve() only stands in where there is no unique minimum (fewer than three pairs; all on a line).
class ClosedFormPoseSolver : public PoseSolver {
  public:
    SolveResult solve(const Correspondences& pairs, const Pose& camera_from_object) const override;
};

}  // namespace nearpose
