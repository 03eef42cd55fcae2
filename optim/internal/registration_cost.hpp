// The distance of all pairs as one function of the pose, for Ceres. Not installed.
#pragma once

#include <ceres/sized_cost_function.h>

#include <Eigen/Core>

#include "core/pose.hpp"
#include "optim/ceres_pose_solver.hpp"
#include "optim/internal/normalised_pairs.hpp"
#include "optim/internal/se3_manifold.hpp"

namespace nearpose {

// All rows of robust residuals r and of their derivatives J with respect to a right perturbation of the pose, summed
// up.
struct NormalEquations {
    Matrix6d jtj = Matrix6d::Zero();
    Twist jtr = Twist::Zero();
    double rtr = 0.0;  // sum of rho(s) over the pairs
};

bool is_finite(const NormalEquations& sums);

// With e the pair's residual (three numbers, or one) and s = |e|^2, the row's residual is e * sqrt(rho(s) / s).
NormalEquations normal_equations(const NormalisedPairs& pairs, const Pose& normalised_pose, ResidualKind kind,
                                 RobustLoss loss, double loss_scale_sigmas);

// The hundreds of rows are handed to Ceres as seven with the same J^T J, J^T r and r^T r: J's Cholesky factor, and what
// of r it cannot explain. Gauss-Newton and Levenberg-Marquardt see nothing else of a function, and a step takes a
// fraction of the time it takes on the rows. (The seven are no smooth functions of the pose one by one.)
class RegistrationCost final : public ceres::SizedCostFunction<7, Se3Manifold::kAmbientSize> {
  public:
    // Keeps a reference to `pairs`, which must be usable.
    RegistrationCost(const NormalisedPairs& pairs, ResidualKind kind, RobustLoss loss, double loss_scale_sigmas);

    // Fails where the cost is not finite: Ceres takes an infinite cost for convergence. To be called by one thread.
    bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

    // Valid until the next call with other parameters.
    const NormalEquations& sums_at(const Se3Manifold::Ambient& parameters) const;

  private:
    const NormalisedPairs& pairs_;
    ResidualKind kind_;
    RobustLoss loss_;
    double loss_scale_sigmas_;
    // Ceres asks for the cost of a step first, and for the derivative at the same place if it takes the step.
    mutable Se3Manifold::Ambient latest_parameters_;
    mutable NormalEquations latest_;
};

}  // namespace nearpose
