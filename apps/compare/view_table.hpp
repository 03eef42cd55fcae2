// The comparison of views alone: every generator at every distance, over many lines of sight.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "apps/runs/estimator_setup.hpp"
#include "apps/tables/results.hpp"
#include "apps/view_quality/view_cell.hpp"

namespace nearpose::compare {

struct ViewTableOptions {
    std::vector<std::string> views = program::view_names();
    std::vector<int> samples = {5000, 20000, 100000};  // ray casting has none and is in the table once
    std::vector<double> distances_mm = {600.0, 400.0, 300.0, 250.0, 200.0, 150.0, 100.0};
    int seeds = 20;  // lines of sight: 1 to this
    int max_rays = 64 * 48;
    int num_threads = 0;  // 0: as many as the machine has
};

// Throws std::invalid_argument naming field, value and bound.
void validate(const ViewTableOptions& options);

// The settings of each row, with the first seed; in the table's order.
std::vector<ViewCell> rows_of(const ViewTableOptions& options);

// Means over the lines of sight with their confidence intervals. `row_done` is called once a row, never twice at the
// same time, and returns false to stop: then rows are missing. Only times depend on the machine and its load.
tables::Table view_table(const ViewBench& bench, const ViewTableOptions& options,
                         const std::function<bool()>& row_done);

}  // namespace nearpose::compare
