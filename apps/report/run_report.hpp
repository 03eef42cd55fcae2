// The report of one run.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

namespace nearpose::report {

struct RunReportOptions {
    std::filesystem::path scene, models;  // where they are now, if not where the run found them; empty: as it says
    int max_points = 2500;                // of a frame's cloud on the part
    int burn_in = 15;                     // frames that the statistics leave out
    int threads = 0;                      // 0: all
};

struct Report {
    std::string title, json;
};

// Reads run.json, log.jsonl, particles.jsonl (the page shows no particles where it is missing) and what they are of:
// scene and model, and scene_gt.json where it is there. `notice` is told what the report goes without. Throws
// std::runtime_error naming the file and what to do.
Report run_report(const std::filesystem::path& folder, const RunReportOptions& options,
                  const std::function<void(const std::string&)>& notice);

}  // namespace nearpose::report
