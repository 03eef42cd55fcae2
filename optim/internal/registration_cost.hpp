// The distance of all pairs as one function of the pose, for Ceres. Not installed.
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "core/base/pose.hpp"
#include "optim/ceres_pose_solver.hpp"
#include "optim/internal/normalised_pairs.hpp"

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
// fraction of the time it takes on the rows. (The seven are no smooth functions of the pose one by one.) Six more say
// "stay where you were linearised last": they damp a step and do not move the minimum. A function of six numbers, for
// ceres::TinySolver:
//   pose(w, v) = (R exp(w), t + R v) of the start (R, t), in normalised coordinates.
class RegistrationCost {
  public:
    using Scalar = double;
    enum { NUM_RESIDUALS = 13, NUM_PARAMETERS = 6 };

    // Keeps a reference to `pairs`, which must be usable. `stay` is the squared weight of the six rows.
    RegistrationCost(const NormalisedPairs& pairs, ResidualKind kind, RobustLoss loss, double loss_scale_sigmas,
                     const Pose& normalised_start);
    void set_stay(double squared_weight) { stay_ = std::sqrt(squared_weight); }

    // Where a sum is not finite the residuals are so large that no solver goes there. `jacobian` is 13 x 6, column by
    // column, or null. To be called by one thread.
    bool operator()(const double* turn_and_shift, double* residuals, double* jacobian) const;

    Pose pose_at(const double* turn_and_shift) const;
    // Of the pairs alone. Valid until the next call with other parameters.
    const NormalEquations& sums_at(const Twist& turn_and_shift) const;

  private:
    const NormalisedPairs& pairs_;
    ResidualKind kind_;
    RobustLoss loss_;
    double loss_scale_sigmas_;
    Pose start_;
    double stay_ = 0.0;
    // The solver asks for the cost of a step first, and for the derivative at the same place if it takes the step.
    mutable Twist latest_parameters_;
    mutable Twist linearised_at_ = Twist::Zero();
    mutable NormalEquations latest_;
};

}  // namespace nearpose
