// Where the part is in the world, such as a robot's base: the pose that a robot acts on, and how well it is known.
#pragma once

#include "core/base/pose.hpp"
#include "core/world/sighting.hpp"
#include "core/world/still_world.hpp"

namespace nearpose {

struct PlaceInWorld {
    Pose world_from_object;
    Matrix6d covariance = Matrix6d::Zero();  // of the twist of world_from_object * exp(twist), rotation first
};

// How far the reported pose of the camera may be off where nothing in the set-up is at fault. The covariance is of the
// twist of world_from_camera * exp(twist), in camera axes and about the camera:
//   C = hand-eye calibration + one pose of the arm + (time offset)^2 m m^T,
// with the camera's motion m of this frame, as in Sighting::camera_motion. Errors of the intrinsics and of the depth's
// scale are not among them: the pose in the camera has them in its own covariance.
Matrix6d camera_pose_covariance(const SetupSigmas& setup, const SightingOptions& arm, const Twist& camera_motion);

// world_from_object = world_from_camera * camera_from_object. A small motion c of the camera, in its own axes, moves
// the part by exp(c) * camera_from_object = camera_from_object * exp(A c), with A = from_camera_twist about the
// object's origin. Pose and camera have independent errors, of the covariances P and C, so that to first order
//   covariance = P + A C A^T.
// `covariance` (P) is that of UpdateResult; a change of the world's frame changes nothing in it.
PlaceInWorld place_in_world(const Pose& camera_from_object, const Matrix6d& covariance, const Pose& world_from_camera,
                            const Matrix6d& camera_pose_covariance);

}  // namespace nearpose
