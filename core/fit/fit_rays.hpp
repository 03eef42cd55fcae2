// The rays of the joint fit: what each measures of the pose and of the sensor's errors, summed as normal equations.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/filter/gradient_step.hpp"
#include "core/fit/sensor_field.hpp"

namespace nearpose {

struct FitRayOptions {
    double gate_sigmas = 5.0;   // a measurement farther from the face belongs to another surface
    double huber_sigmas = 2.0;  // a larger residual pulls with constant force (Huber 1964)
    // A ray is compared with pixels up to this distance on either side, in spacings of the rays. At 0.4 the pixels of
    // neighbouring rays do not overlap.
    double reach_spacings = 0.4;
    // Two rays meet the same face where the line between their points is tilted out of both tangent planes by less:
    // the sine of that angle.
    float coplanar_sine = 0.05F;
};

// Where the rays' residuals are linearised.
struct Linearisation {
    Pose camera_from_object;
    Eigen::VectorXd errors;  // of the sensor, as far as they are known; used for weights and gate alone
    double extra_sigma_m;    // how far off the pose may still be; widens the gate and the bound of an outlier
};

// Errors that are the same in every frame and can hardly be told from the pose: the part's scale against its CAD, about
// its centre [1]; the focal length [1]; the principal point [pixels].
inline constexpr int kConstantErrors = 4;

// Normal equations at the pose and at zero errors. The unknowns are the twist about the model's centre, the field's
// unknowns, and the constant errors.
struct FitEquations {
    explicit FitEquations(Eigen::Index field_unknowns)
        : sums(Eigen::MatrixXd::Zero(6 + field_unknowns + kConstantErrors + 1,
                                     6 + field_unknowns + kConstantErrors + 1)),
          unknowns(field_unknowns) {}

    Eigen::MatrixXd sums;  // of weight * row * row^T, row = (derivatives, residual)
    Eigen::Index unknowns;
    int rays = 0;  // that take part
    // |residual| / sigma of each ray that is away from depth steps, after the known errors
    std::vector<double> scaled_residuals;
};

// Each ray keeps the face that it met in `view`, which was cast at a pose near by: only the face's plane moves with the
// pose.
FitEquations linearise(const Linearisation& at, const View& view, const SensorField& field, const StepContext& context,
                       const FitRayOptions& options = {});

}  // namespace nearpose
