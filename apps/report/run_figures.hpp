// The figures of a run, as JSON for the page.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "apps/error_measures/run_summary.hpp"
#include "apps/report/run_input.hpp"

namespace nearpose::report {

// Errors of every logged frame; without errors where the truth or the pose is not known.
std::vector<evaluation::FrameErrors> errors_of_run(const RunInput& input);

// Without truth: counts, verdicts and times alone.
nlohmann::ordered_json figures_json(const RunInput& input, const std::vector<evaluation::FrameErrors>& errors,
                                    int burn_in);

// One standard deviation of an estimate: of the part's centre [mm], and of its rotation [deg]; root of the trace.
struct Sigma {
    double translation_mm = 0.0, rotation_deg = 0.0;
};
Sigma sigma_of(const Matrix6d& covariance, const Eigen::Vector3d& centre_in_object);

}  // namespace nearpose::report
