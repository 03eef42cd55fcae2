// What faults do to the poses that the arm reports, to the written intrinsics, and to where the part is.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "apps/scenes/fault.hpp"
#include "core/base/camera.hpp"
#include "core/base/pose.hpp"

namespace nearpose::simulate {

// camera_from_world of every frame of the path, as reported without these faults. They act in their order; those of
// other kinds change nothing.
std::vector<Pose> with_arm_faults(std::vector<Pose> camera_from_world, const std::vector<Fault>& faults,
                                  std::uint64_t seed);

// The intrinsics that are written with a frame; the image's size stays.
PinholeCamera written_camera(PinholeCamera camera, const std::vector<Fault>& faults, int frame);

// scene_from_moved of a part that was at the scene's identity, by kPushed and kCarried; nothing before they begin. It
// moves along the ground in a drawn direction, and turns about the vertical through its box's centre.
std::optional<Pose> part_motion(const std::vector<Fault>& faults, const Pose& scene_from_ground, std::uint64_t seed,
                                int frame);

}  // namespace nearpose::simulate
