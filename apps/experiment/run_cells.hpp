// The work: recordings that are simulated frame by frame and tracked by several estimators at once, and views that are
// measured by themselves.
#pragma once

#include <functional>
#include <vector>

#include "apps/experiment/cell.hpp"
#include "apps/experiment/run_setup.hpp"

namespace nearpose::experiment {

// Cells of the same recording: `settings` agree in all that is of use kRecording. Every frame is made once; cells that
// also agree in the estimator are tracked once. The CPU time of a frame is that of its observation and the update, of
// this thread. Serial; the results depend on nothing else. `go_on` is asked once a frame: empty where it said no.
std::vector<CellResult> run_recording(const std::vector<Settings>& settings, std::uint64_t seed, Workshop& workshop,
                                      const std::function<bool()>& go_on);

// Figures of a generator's views; none for a line of sight that meets nothing.
CellResult run_views(const Settings& settings, std::uint64_t seed, Workshop& workshop);

// Figures and times of a run, from its frames and the CPU time of each [s].
CellResult run_result(std::vector<evaluation::FrameErrors> frames, const std::vector<double>& cpu_s,
                      double model_diameter_m, const evaluation::SummaryOptions& options);

}  // namespace nearpose::experiment
