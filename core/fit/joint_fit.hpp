// The joint fit, the last step of the chosen mode: least squares over the pose and the sensor's systematic errors.
// Neighbouring pixels share errors. A fit that takes them for independent is biased by broad faces, and its covariance
// is far too small.
#pragma once

#include "core/base/pose.hpp"
#include "core/filter/gradient_step.hpp"
#include "core/fit/fit_rays.hpp"
#include "core/fit/sensor_field.hpp"
#include "core/fit/variance_components.hpp"

namespace nearpose {

struct FitOptions {
    int max_rounds = 4;  // of Gauss-Newton
    // How far off the start may be beyond the noise, in sigmas of the sensor's smooth error field. In the first round
    // alone, gate and robust weights are wider by it.
    double first_extra_field_sigmas = 2.0;
    // The largest shift of any model point in a round, in sigmas of the sensor's noise: the fit has converged below the
    // first, and below the second the rays still meet the same faces, so that no new view is cast.
    double converged_sigmas = 0.2;
    double same_faces_sigmas = 1.0;
    // Weak prior of the pose about its start, where the rays leave a direction open.
    double prior_rotation_rad = 1.0;
    double prior_translation_diameters = 1.0;
    // A property of the part, not of the sensor: it is larger or smaller than its CAD by this share of itself.
    double part_scale_sigma = 0.001;
    // The default sensor model is on the wide side: where it holds, residuals come out at this share of their sigmas.
    // The covariance counts noise beyond that as noise beyond the model.
    double usual_unit_sigma = 0.7;
    // An image noisier than its sensor's model by more than this factor has larger shared errors too, in proportion.
    double usual_noise_factor = 1.5;
    FitRayOptions rays;
    FieldOptions field;
    GroupVarianceOptions field_variance;
};

// Throws std::invalid_argument naming field, value and bound.
void validate(const FitOptions& options);

// Errors of the set-up that the fit leaves alone.
enum SetupError : Eigen::Index { kFocalLengthError, kImageColumns, kImageRows, kDepthScaleError };
inline constexpr Eigen::Index kSetupErrors = 4;
// The twist that a fit is off by for each error of size 1: the focal length is larger by its own size, the principal
// point by one column or row, the measured depth by its own size.
using SetupEffect = Eigen::Matrix<double, 6, kSetupErrors>;

// Covariances are of the twist about the model's centre, in object axes, rotation first.
struct JointFit {
    Pose camera_from_object;
    Matrix6d covariance = Matrix6d::Zero();
    int pairs = 0;  // rays that took part
    // To be added: the covariance of errors that are the same in every frame, which no number of frames averages out:
    // of the part's scale against its CAD, of the camera's focal length and principal point.
    Matrix6d constant_covariance = Matrix6d::Zero();
    // Of what neighbouring rays are off together, as these residuals show it: errors of the sensor and of the CAD [m].
    double shared_sigma_m = 0.0;
    SetupEffect setup_effect = SetupEffect::Zero();
};

// Gauss-Newton from a pose in the basin of attraction, such as a refined mode. A new view is cast each round, and the
// residuals are robust point-to-plane distances along the normals n of the rays' faces:
//   r = n . (measured - model) = J twist + n_z (field + scale * depth) + noise.
// The field's nodes and the scale are unknowns of known variance. Where residuals are larger than the sensor explains
// (variance_components.hpp) they weigh less, and the covariance grows with them and with the field that is seen.
JointFit fit_jointly(const Pose& start, const StepContext& context, const FitOptions& options = {});

// The covariance alone, constant part included, at a pose that is kept.
Matrix6d covariance_at(const Pose& camera_from_object, const StepContext& context, const FitOptions& options = {});

// Between twists about the model's centre and twists of camera_from_object * exp(twist), about the object's origin.
Matrix6d about_origin(const Matrix6d& covariance_about_centre, const Eigen::Vector3d& centre_in_object);
Matrix6d about_centre(const Matrix6d& covariance_about_origin, const Eigen::Vector3d& centre_in_object);

}  // namespace nearpose
