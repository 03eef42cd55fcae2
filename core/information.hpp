// What an observation says about a pose, and how surely.
#pragma once

#include "core/correspondence.hpp"
#include "core/pose.hpp"

namespace nearpose {

// Information (inverse covariance) that point-to-plane pairs with independent noise hold about the twist of
// pose * exp(twist): sum of J^T J / sigma^2, J = [(p x n)^T, n^T] with the pair's point and normal in object axes. The
// order is rotation first; units 1/rad^2, 1/(rad m), 1/m^2.
Matrix6d information_of(const Correspondences& pairs);

struct CovarianceOptions {
    double rays_per_shared_error = 1.0;  // so many neighbouring rays share one systematic error
    double systematic_sigma_m = 0.0;     // its standard deviation [m]
    double prior_rotation_rad = 1.0;     // standard deviations of a weak prior: what stays where the pairs say nothing
    double prior_translation_m = 0.1;
};

// Covariance of the twist of pose * exp(twist). On top of the independent noise the sensor has errors that neighbouring
// rays share: they are not averaged away within a patch of `rays_per_shared_error` rays, so they count with the
// information of one ray a patch.
Matrix6d covariance_of(const Correspondences& pairs, const CovarianceOptions& options);

}  // namespace nearpose
