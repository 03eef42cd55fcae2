// The distance of all pairs as one function of the pose, for Ceres. Not installed.
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "core/base/pose.hpp"
#include "optim/ceres_pose_solver.hpp"
#include "optim/internal/normalised_pairs.hpp"

namespace nearpose {

// What the residual of a pair is, and how outliers are held down.
struct RobustResidual {
    ResidualKind kind = ResidualKind::kPointToPlane;
    RobustLoss loss = RobustLoss::kNone;
    double loss_scale_sigmas = 1.0;
};

// The normal equations of the registration, J^T J d = -J^T r: sums over the rows of robust residuals r and of their
// derivatives J with respect to a perturbation d of the pose on the right, pose * exp(d), rotation first.
struct RegistrationEquations {
    Matrix6d jtj = Matrix6d::Zero();
    Twist jtr = Twist::Zero();
    double rtr = 0.0;  // sum of rho(s) over the pairs
};

bool is_finite(const RegistrationEquations& sums);

// With e the pair's residual (three numbers, or one) and s = |e|^2, the row's residual is e * sqrt(rho(s) / s).
RegistrationEquations registration_equations(const NormalisedPairs& pairs, const Pose& normalised_pose,
                                             const RobustResidual& residual);

// The distance of all pairs as a function of six numbers (w, v), for ceres::TinySolver:
//   pose(w, v) = (R exp(w), t + R v) of the start (R, t), in normalised coordinates.
// The hundreds of rows of the pairs are handed to Ceres as seven with the same J^T J, J^T r and r^T r: the Cholesky
// factor of J^T J, and one row for the part of r that no step explains. Gauss-Newton and Levenberg-Marquardt use
// nothing else of a function, and a step takes a fraction of the time. (One by one the seven are no smooth functions of
// the pose.) Six more rows pull towards the place of the last linearisation: they damp a step and do not move the
// minimum.
class RegistrationCost {
  public:
    using Scalar = double;
    enum { NUM_RESIDUALS = 13, NUM_PARAMETERS = 6 };

    // Keeps a reference to `pairs`, which must be usable. `stay` is the squared weight of the six rows.
    RegistrationCost(const NormalisedPairs& pairs, const RobustResidual& residual, const Pose& normalised_start);
    void set_stay(double squared_weight) { stay_ = std::sqrt(squared_weight); }

    // Where a sum is not finite the residuals are so large that no solver goes there. `jacobian` is 13 x 6, column by
    // column, or null. To be called by one thread.
    bool operator()(const double* turn_and_shift, double* residuals, double* jacobian) const;

    Pose pose_at(const double* turn_and_shift) const;
    // The equations of the pairs alone. Valid until the next call with other parameters.
    const RegistrationEquations& sums_at(const Twist& turn_and_shift) const;

  private:
    const NormalisedPairs& pairs_;
    RobustResidual residual_;
    Pose start_;
    double stay_ = 0.0;
    // The solver asks for the cost of a step first, and for the derivative at the same place if it takes the step.
    mutable Twist latest_parameters_;
    mutable Twist linearised_at_ = Twist::Zero();
    mutable RegistrationEquations latest_;
};

}  // namespace nearpose
