// The report of an experiment: its tables and curves.
#pragma once

#include <filesystem>

#include "apps/report/run_report.hpp"

namespace nearpose::report {

// Throws std::runtime_error naming file and key.
Report experiment_report(const std::filesystem::path& results_json);

}  // namespace nearpose::report
