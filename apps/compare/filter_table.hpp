// The comparison in the filter: what becomes of the views' faults.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "apps/compare/filter_run.hpp"
#include "apps/tables/results.hpp"

namespace nearpose::compare {

std::optional<double> visible_distance(const evaluation::FrameErrors& frame);  // [m]

struct FilterTableOptions {
    std::vector<double> distances_mm;  // each frame counts for the nearest, by ratio
    // Of a frame [m], none where it has no distance. By itself that of the mean of its visible points.
    std::function<std::optional<double>(const evaluation::FrameErrors&)> distance_of = visible_distance;
    std::string distance_name = "distance of the visible points' mean";
    int seeds = 20;
    int num_threads = 0;
};

// results[filter][seed - 1]: the frames of a run. Empty where `go_on` said no. `run_done` is called once a seed, never
// twice at the same time. Grids of hours that are to go on where they ended are described for `nearpose experiment`.
using FilterResults = std::vector<std::vector<std::vector<evaluation::FrameErrors>>>;
FilterResults filter_results(const std::vector<ComparedFilter>& filters,
                             const std::function<FilterRecording(std::uint64_t)>& recording_of,
                             const FilterTableOptions& options, const std::function<bool()>& go_on,
                             const std::function<void()>& run_done);

// Error, arrival and CPU time of whole runs; then how well the pose is kept at each distance.
std::vector<tables::Table> filter_tables(const std::vector<ComparedFilter>& filters, const FilterResults& results,
                                         const FilterTableOptions& options);

}  // namespace nearpose::compare
