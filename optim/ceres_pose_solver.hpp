// The gradient step of the filter: least squares over SE(3) with Ceres, robust, on points or on planes.
#pragma once

#include "core/base/pose.hpp"
#include "core/correspondences.hpp"
#include "core/pose_solver.hpp"

namespace nearpose {

enum class ResidualKind {
    kPointToPoint,  // three per pair: (camera_from_object * p - q) / sigma
    kPointToPlane,  // one per pair: the same difference along the view's exact normal
};

// rho(s) of the squared residual s, with the scale a in units of sigma; rho(s) = s for s -> 0 in all of them.
enum class RobustLoss {
    kNone,    // s
    kHuber,   // s up to a^2, then 2 a sqrt(s) - a^2
    kCauchy,  // a^2 log(1 + s / a^2)
    kTukey,   // a^2 / 3 (1 - (1 - s / a^2)^3) up to a^2, then constant: an outlier has no pull at all
};

struct CeresSolverOptions {
    ResidualKind residual = ResidualKind::kPointToPlane;
    RobustLoss loss = RobustLoss::kHuber;
    double loss_scale_sigmas = 2.0;
    int max_iterations = 5;
    int min_pairs = 6;                 // at least 6 for point to plane, 3 for point to point
    double function_tolerance = 1e-6;  // stop when the cost falls by less than this fraction
    // Least weight of "stay where you are" in a step, as a fraction of the data's whole weight. It keeps what the pairs
    // do not determine (a shift along a plane) from following their noise, and does not move the minimum.
    double damping = 1e-4;
};

// Throws std::invalid_argument with field, value and bound.
void validate(const CeresSolverOptions& options);

class CeresPoseSolver : public PoseSolver {
  public:
    explicit CeresPoseSolver(const CeresSolverOptions& options = {});

    SolveResult solve(const Correspondences& pairs, const Pose& camera_from_object) const override;

  private:
    CeresSolverOptions options_;
};

}  // namespace nearpose
