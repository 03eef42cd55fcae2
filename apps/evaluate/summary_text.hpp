// The figures of a run for people and for programs.
#pragma once

#include <string>
#include <vector>

#include "apps/error_measures/run_summary.hpp"

namespace nearpose::evaluation {

struct SummaryHeading {
    std::string scene, results;
    int scene_id = 0, object_id = 0;
    double model_diameter_m = 0.0;
};

// A table with units, of the frames that `summary` is of.
std::string summary_text(const SummaryHeading& heading, const std::vector<FrameErrors>& frames,
                         const RunSummary& summary, const SummaryOptions& options);

// All figures as JSON with "format": 1; what is not known is null.
std::string summary_json(const SummaryHeading& heading, const std::vector<FrameErrors>& frames,
                         const RunSummary& summary, const SummaryOptions& options);

}  // namespace nearpose::evaluation
