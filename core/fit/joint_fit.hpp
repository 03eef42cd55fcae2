// The last step of the chosen mode: least squares over the pose and the sensor's systematic errors together.
// Neighbouring pixels share errors; who weighs them as independent is pulled about by broad faces and believes to know
// the pose far better than is so.
#pragma once

#include "core/base/pose.hpp"
#include "core/filter/gradient_step.hpp"

namespace nearpose {

struct JointFit {
    Pose camera_from_object;
    Matrix6d covariance = Matrix6d::Zero();  // of the twist about the model's centre, in object axes, rotation first
    int pairs = 0;
    // The same, of what is equally wrong in every frame, so that no number of frames averages it out: the part is
    // larger or smaller than its CAD. To be added.
    Matrix6d constant_covariance = Matrix6d::Zero();
};

// Gauss-Newton from a pose in the basin (such as a refined mode), a view cast anew each round, robust point-to-plane
// residuals along the rays' normals,
//   r = n . (measured - model) = J twist + n_z (field + scale * depth) + noise,
// with the field's nodes and the scale as unknowns of known variance. Where residuals are larger than the sensor
// explains (variance_components.hpp) they weigh less, and the covariance grows with them and with the field that is
// seen. A weak prior (1 rad, one diameter) stands in where the pairs say nothing.
JointFit fit_jointly(const Pose& start, const StepContext& context);

// The covariance alone, at a pose that is kept.
Matrix6d covariance_at(const Pose& camera_from_object, const StepContext& context);

// Between twists about the model's centre and twists of camera_from_object * exp(twist), about the object's origin.
Matrix6d about_origin(const Matrix6d& covariance_about_centre, const Eigen::Vector3d& centre_in_object);
Matrix6d about_centre(const Matrix6d& covariance_about_origin, const Eigen::Vector3d& centre_in_object);

}  // namespace nearpose
