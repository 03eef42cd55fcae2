// The camera's paths of the scenarios. All are camera_from_object unless they say otherwise, one pose a frame.
#pragma once

#include <vector>

#include "apps/scenes/scenario.hpp"
#include "core/base/random.hpp"

namespace nearpose::simulate {

// The camera at `eye` that looks at `target` (object frame). Its x axis is `x_hint` without the part along the line of
// sight, turned by `roll_rad` about that line; x_hint may not be parallel to it.
Pose look_at(const Eigen::Vector3d& eye, const Eigen::Vector3d& target, const Eigen::Vector3d& x_hint, double roll_rad);

// The unit axis that is farthest from `direction`: a hint that is not parallel.
Eigen::Vector3d axis_across(const Eigen::Vector3d& direction);

// 0 in the first frame, 1 in the last.
double progress_of(int frame, int num_frames);

// camera_from_scene of a camera that stands still and has the whole box of the part in view in all of its poses.
Pose whole_view(const Part& part, const std::vector<Pose>& scene_from_object, const PinholeCamera& camera,
                std::uint64_t seed);

// The same part lying on its upper face: turned by half a turn about x.
Part turned_over(const Part& part);
Pose turned_from_object();  // its own inverse

std::vector<Pose> approach_path(const Part& part, int num_frames, std::uint64_t seed, const ScenarioOptions& options);
std::vector<Pose> sweep_path(const Part& part, int num_frames, std::uint64_t seed, const ScenarioOptions& options);

// The part's scene_from_object on the conveyor.
std::vector<Pose> conveyor_motion(const Part& part, int num_frames, std::uint64_t seed, const ScenarioOptions& options);

// Slowly around the part with its whole box in view; it looks down at `min_elevation_rad` at least.
struct OrbitLimits {
    double min_elevation_rad = 0.70, max_elevation_rad = 1.15;  // of the camera over the table
    double max_swing_rad = 0.5;                                 // around the vertical, over the path
};
std::vector<Pose> orbit_path(const Part& part, const PinholeCamera& camera, int num_frames, std::uint64_t seed,
                             const OrbitLimits& limits);

// As a hand carries it: the trajectory of the options, or a made-up one.
std::vector<Pose> hand_path(const Part& part, int num_frames, std::uint64_t seed, const ScenarioOptions& options,
                            double frames_per_second);

}  // namespace nearpose::simulate
