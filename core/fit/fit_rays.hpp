// The fine fit's rays: what each measures of the pose and of the shared errors, summed up as normal equations.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/filter/gradient_step.hpp"
#include "core/fit/sensor_field.hpp"

namespace nearpose {

// Where the rays' residuals are linearised.
struct Linearisation {
    Pose camera_from_object;
    Eigen::VectorXd errors;  // of the sensor, as far as is known: for weights and gate
    double extra_sigma_m;    // how far off the pose may still be: for the gate and what counts as an outlier
};

// Over (twist about the model's centre, the field's unknowns, the part's scale about its centre against its CAD), at
// the pose and at zero errors.
struct FitEquations {
    explicit FitEquations(Eigen::Index unknowns_beside_pose)
        : sums(Eigen::MatrixXd::Zero(6 + unknowns_beside_pose + 1, 6 + unknowns_beside_pose + 1)),
          unknowns(unknowns_beside_pose) {}

    Eigen::MatrixXd sums;  // of weight * row * row^T, row = (derivatives, residual)
    Eigen::Index unknowns;
    std::vector<double> scaled_residuals;  // |residual| / sigma of each ray, the known errors taken off
};

// The rays keep the faces that they met in `view`, which was cast at a pose near by.
FitEquations linearise(const Linearisation& at, const View& view, const SensorField& field, const StepContext& context);

}  // namespace nearpose
