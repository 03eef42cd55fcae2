// What a run wrote about its frames, read back.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/pose.hpp"
#include "core/evidence/verdict.hpp"
#include "core/world/place_in_world.hpp"

namespace nearpose::report {

// What kept a frame from being accepted, as its log says it.
struct LoggedLack {
    std::string requirement, text;
};

// What image and arm say against each other.
struct LoggedArm {
    std::string moves;  // "as if the arm's motion were inverted"; empty: as the arm says
    std::string cause;  // of a part that seems to move; empty: it stands still
    double off_share = 0.0, error_bound_m = 0.0;
};

struct LoggedFrame {
    int frame_id = 0;
    double stamp_s = 0.0;
    std::string status, error;
    std::optional<Verdict> verdict;   // the oldest logs have none
    std::vector<LoggedLack> missing;  // and later ones do not say why
    std::optional<Pose> camera_from_object;
    std::optional<Matrix6d> covariance;
    std::optional<double> score, agreement, cost;  // the oldest logs do not have the agreement
    std::optional<PlaceInWorld> in_world;          // where the camera's pose was known; older logs do not have it
    std::optional<LoggedArm> arm;                  // nor this
    double effective_sample_size = 0.0;
    int points_observed = 0;
    bool resampled = false, mode_replaced = false;
    double time_s = -1.0;
};

// Both throw std::runtime_error naming file, line and key.
std::vector<LoggedFrame> read_run_log(const std::filesystem::path& log_jsonl);

// x y z [m], quaternion x y z w, weight.
using ParticleRow = std::array<float, 8>;
// By frame; of more than `max_particles` those of the largest weight.
std::map<int, std::vector<ParticleRow>> read_particles(const std::filesystem::path& particles_jsonl,
                                                       std::size_t max_particles);

}  // namespace nearpose::report
