// The folder of a run (`nearpose estimate --run DIR`): what it was told, what it found.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "apps/runs/run_options.hpp"

namespace nearpose::program {

inline constexpr const char *kRunFile = "run.json", *kPosesFile = "poses.csv", *kLogFile = "log.jsonl",
                            *kTrajectoryFile = "poses.tum", *kParticlesFile = "particles.jsonl";

// run.json: every option with its value, the program's version, paths made absolute.
void write_run_record(const std::filesystem::path& folder, const EstimateOptions& options, int scene_id);

struct RunRecord {
    EstimateOptions options;  // paths are absolute
    int scene_id = 0;
    std::vector<std::pair<std::string, std::string>> program;  // "nearpose", "0.1.0" and so on
};
// Throws std::runtime_error naming file and key.
RunRecord read_run_record(const std::filesystem::path& folder);

}  // namespace nearpose::program
