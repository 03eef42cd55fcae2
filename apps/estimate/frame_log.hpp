// The logs of an estimation, of frames and of particles: one JSON object a line. The first says the format, the others
// are frames.
#pragma once

#include <optional>
#include <string>

#include "core/estimator.hpp"
#include "core/world/place_in_world.hpp"

namespace nearpose::program {

// What the run was told, for the first line.
struct RunDescription {
    std::string input, model, views, method;
    int scene_id = 0, object_id = 0;
    int particles = 0;
    bool adaptive = false;  // fewer in tracking
    std::uint64_t seed = 0;
    Tolerance tolerance = {};  // of the verdicts
    double budget_s = 0.0;     // for a frame; 0: none
};

struct FrameReport {
    int frame_id = 0;
    double stamp_s = 0.0;
    double time_s = 0.0;                   // wall time of the frame, without decoding its files
    std::string error;                     // why it could not be read; empty where it could
    std::optional<PlaceInWorld> in_world;  // where the camera's pose is known
};

// Covariance as ROS has it: of (x y z, rotation about x y z) in the fixed axes of the frame that the pose leads to, the
// camera's or the world's, from that of the right perturbation (rotation first, object axes) of the pose. For small
// noise: A C A^T, A = [[0, R], [R, 0]].
Matrix6d ros_covariance(const Matrix6d& covariance, const Pose& frame_from_object);

std::string first_log_line(const RunDescription& run);
// Without a pose the keys that describe one are left out.
std::string frame_log_line(const FrameReport& frame, const UpdateResult& result);

std::string first_particles_line();
// {"frame": 3, "particles": [[x, y, z, qx, qy, qz, qw, weight], ...]}: camera_from_object with 6 significant digits and
// its share of all weight.
std::string particles_line(int frame_id, const ParticleSet& particles);

}  // namespace nearpose::program
