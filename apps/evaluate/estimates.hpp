// What an estimation said: its result file and its log.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "apps/error_measures/frame_errors.hpp"
#include "apps/error_measures/scene_truth.hpp"
#include "core/evidence/verdict.hpp"

namespace nearpose::evaluation {

struct Estimates {
    std::filesystem::path results;           // the file they are from, for messages
    std::map<int, EstimatedFrame> of_frame;  // by frame number
    std::map<int, Verdict> verdicts;         // by frame number, of frames without a pose too; empty: not known
    std::optional<Tolerance> tolerance;      // of the verdicts, where the log states it
    std::vector<std::string> notices;        // what was passed over
};

// The rows of the scene and object. Of several rows of a frame the one with the highest score counts. Throws
// std::runtime_error where the file is of another scene or object (naming both), or has a frame that the scene lacks.
Estimates read_estimates(const std::filesystem::path& results_csv, const SceneTruth& truth);

// Adds covariances, verdicts, and which poses are predictions, from the log of the same run (nearpose estimate --log).
// Logs from before there were verdicts have none. The first line may state what the verdicts were given for:
// tolerance_m and tolerance_rad. Throws std::runtime_error naming file and line where it is no such log or its poses
// are not those of `estimates`.
void add_log(const std::filesystem::path& log_jsonl, Estimates& estimates);

// Parallel to truth.frames.
std::vector<FrameErrors> errors_of(const SceneTruth& truth, const Estimates& estimates, const ModelShape& shape);

}  // namespace nearpose::evaluation
