// The errors of a set-up, from one approach to a part that stands still: what of camera, hand-eye calibration and
// clocks makes the part seem to move in the world. Least squares with Ceres beside the filter, fed with its joint fits.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/world/sighting.hpp"
#include "core/world/still_world.hpp"

namespace nearpose {

// The unknowns: first those of SetupError (focal length, columns, rows, depth scale), by how much what was given is
// larger than the truth. Then the hand-eye error given_from_camera, as turn [rad] and shift [m]: the camera lies so
// beside where the arm says. Last the time [frames] by which the arm's poses are later than their images.
enum SetupUnknown : Eigen::Index {
    kHandEyeTurn = kSetupErrors,
    kHandEyeShift = kHandEyeTurn + 3,
    kTimeOffset = kHandEyeShift + 3,
    kSetupUnknowns
};
using SetupVector = Eigen::Matrix<double, kSetupUnknowns, 1>;
using SetupMatrix = Eigen::Matrix<double, kSetupUnknowns, kSetupUnknowns>;

// Standard deviations in the order of the unknowns.
SetupVector in_order(const SetupSigmas& sigmas);

struct SetupCalibrationOptions {
    // Gaussian prior of the unknowns. What the motion does not show stays at its mean, with its sigma.
    SetupVector prior_mean = SetupVector::Zero();
    SetupVector prior_sigma = in_order(StillWorldOptions{}.faulty);
    // Sightings of similar views share their errors: so many count as one.
    double sightings_per_error = StillWorldOptions{}.sightings_per_error;
    double loss_sigmas = 4.0;  // scale of the robust loss (Cauchy) of a sighting: some are wrong
    int min_sightings = 8;
    int max_iterations = 100;
};

// Throws std::invalid_argument naming field, value and bound.
void validate(const SetupCalibrationOptions& options);

struct SetupCalibration {
    bool solved = false;  // enough sightings, and the solver converged
    int sightings = 0;    // that took part
    SetupVector errors = SetupVector::Zero();
    SetupMatrix covariance = SetupMatrix::Zero();
    Pose arm_from_object;  // in the frame in which the sightings have the arm
    // By how much larger the sightings scatter about the solution than their covariances say, by the median. Where it
    // is far above 1, something else is wrong, or the part moved; the covariance is larger by its square.
    double unit_sigma = 0.0;
    // How likely the sightings are under this prior, but for what all priors share [nats] (Laplace's approximation).
    double log_evidence = 0.0;
};

// Maximum a posteriori of the unknowns and of the part's place. For each sighting, with the twist about the model's
// centre in object axes:
//   twist(arm_from_object, arm_from_given exp(-time * motion) given_from_camera camera_from_object exp(-effect *
//   errors))
// is noise of the sighting's covariance. Only the longest run of sightings of one mode takes part.
SetupCalibration calibrate_setup(const std::vector<Sighting>& sightings, const Eigen::Vector3d& centre_in_object,
                                 const SetupCalibrationOptions& options = {});

}  // namespace nearpose
