// The part's place in the world, as one image and the arm's pose with it give it. A part that stands still keeps its
// place while the camera moves; what is wrong in the set-up makes it seem to move.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/base/pose.hpp"
#include "core/base/statistics.hpp"
#include "core/fit/joint_fit.hpp"

namespace nearpose {

// One image's own fit, and where the arm had the camera. Twists are about the model's centre, in object axes.
struct Sighting {
    Pose arm_from_camera;                            // the arm's motion, added up since the first sighting
    Pose camera_from_object;                         // by this image alone
    Matrix6d covariance = Matrix6d::Zero();          // of the image's own errors and of the arm's
    SetupEffect setup_effect = SetupEffect::Zero();  // what the fit takes errors of the set-up for
    Twist camera_motion = Twist::Zero();             // of this frame, in camera axes
    bool other_mode = false;                         // than that of the sighting before
    bool moved = false;                              // something was moved since the sighting before

    Pose arm_from_object() const { return arm_from_camera * camera_from_object; }
};

// The last sightings, oldest first: a sliding window.
struct Sightings {
    std::vector<Sighting> kept;
    Pose arm_from_camera;  // of the last frame, with or without a sighting
    Twist camera_motion = Twist::Zero();
    // Since the part was moved, or another mode took the place of an accepted pose; nothing where neither has happened.
    // From then on every change of the mode counts.
    std::optional<int> frames_since_move;
};

struct SightingOptions {
    int max_count = 48;
    // The camera has to move or turn by so much, in shares of its distance and in rad, before another sighting is kept.
    // Until then the newest replaces the one before: at rest nothing is learned.
    double min_motion = 0.004;
    // Errors of each of the arm's poses, independent in every frame, about and along the camera's axes.
    double arm_rotation_rad = 0.0005;
    double arm_translation_m = 0.0002;
    // A part that goes on as it moved before was not moved: squared Mahalanobis distance of two successive steps.
    double goes_on_chi_square = kChiSquare6_999;
};

// Throws std::invalid_argument naming field, value and bound.
void validate(const SightingOptions& options);

// The camera moved; without a measured motion nothing holds that was seen before.
Sightings after_motion(Sightings sightings, const std::optional<Pose>& now_from_before);

// How a fit follows the one before.
enum class Continuity {
    kAsPredicted,
    kContradicted,       // it is not where the arm's motion puts the part
    kOtherMode,          // of the posterior: it says nothing of the motion
    kOtherThanAccepted,  // the same, in the place of a pose that was accepted
};

// One more sighting at the present arm_from_camera, by an image's own fit.
Sightings with_sighting(Sightings sightings, const JointFit& fit, Continuity continuity,
                        const Eigen::Vector3d& centre_in_object, const SightingOptions& options);

}  // namespace nearpose
