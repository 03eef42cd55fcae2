// The camera's motion as a robot arm that carries it would report it.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/pose.hpp"

namespace nearpose::simulate {

struct ArmErrors {
    // Of each reported pose, independent in every frame, along and about each of the camera's axes. A control, the
    // difference of two poses, carries sqrt(2) of it.
    double sigma_translation_m = 1e-4;
    double sigma_rotation_rad = 3.4906585e-4;  // 0.02 degrees
    // Of the calibration between hand and camera: the same in all frames, of this size in a drawn direction.
    double hand_eye_translation_m = 0.0;
    double hand_eye_rotation_rad = 0.0;
    // The pose that is reported with a frame is the camera's so long after the frame's stamp (negative: before).
    double time_offset_s = 0.0;
};

// Throws std::invalid_argument naming field, value and bound.
void validate(const ArmErrors& errors);

// camera_from_world of every frame, one every 1 / frames_per_second. The scene stands still at a drawn pose in the
// world. A hand-eye error X acts on the camera's side: X * camera_from_world, so that a reported motion is X * motion *
// X^-1.
std::vector<Pose> measured_motion(const std::vector<Pose>& camera_from_scene, const ArmErrors& errors,
                                  std::uint64_t seed, double frames_per_second = 30.0);

// X of the errors alone.
Pose hand_eye_error(const ArmErrors& errors, std::uint64_t seed);

// The pose of a path (at least one pose) at `place`, counted in frames: between two frames on the geodesic, beyond the
// ends with the velocity of the last step.
Pose pose_on_path(const std::vector<Pose>& path, double place);

}  // namespace nearpose::simulate
