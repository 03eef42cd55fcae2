#include "apps/compare/view_table.hpp"

#include <algorithm>
#include <atomic>
#include <mutex>

#include "apps/base/number_text.hpp"
#include "apps/error_measures/run_summary.hpp"
#include "core/base/check.hpp"
#include "core/base/parallel.hpp"

namespace nearpose::compare {
namespace {

struct Quantity {
    const char* number;  // of ViewBench::numbers
    tables::Column column;
};

const std::vector<Quantity>& quantities() {
    static const std::vector<Quantity> all = {{"points_per_view", {"points a view", "", 0}},
                                              {"wrong_percent", {"wrongly visible", "%", 2}},
                                              {"missing_percent", {"missing", "%", 2}},
                                              {"mean_distance_mm", {"off the surface, mean", "mm", 3}},
                                              {"distance_95_mm", {"95 % of a view", "mm", 3}},
                                              {"max_distance_mm", {"max of a view", "mm", 2}},
                                              {"cpu_ms_per_200_views", {"CPU for 200 views", "ms", 1}},
                                              {"cpu_ratio_to_raycast", {"of ray casting's", "", 2}}};
    return all;
}

std::string generator_name(const ViewCell& cell) {
    if (cell.views == "raycast") return cell.views;
    return cell.views + " " + std::to_string(cell.view_samples);
}

// All lines of sight of one row; those that meet nothing are left out.
std::vector<std::vector<NamedNumber>> runs_of(const ViewBench& bench, ViewCell cell, int seeds) {
    std::vector<std::vector<NamedNumber>> runs;
    for (int seed = 1; seed <= seeds; ++seed) {
        cell.seed = static_cast<std::uint64_t>(seed);
        std::vector<NamedNumber> numbers = bench.numbers(cell);
        if (!numbers.empty()) runs.push_back(std::move(numbers));
    }
    return runs;
}

std::vector<double> values_of(const std::vector<std::vector<NamedNumber>>& runs, const std::string& name) {
    std::vector<double> values;
    for (const auto& run : runs) {
        for (const NamedNumber& number : run) {
            if (number.name == name) values.push_back(number.value);
        }
    }
    return values;
}

tables::Row row_of(const ViewCell& cell, const std::vector<std::vector<NamedNumber>>& runs) {
    tables::Row row;
    row.label = data_set::format_number(cell.distance_mm) + " mm, " + generator_name(cell);
    row.runs = static_cast<int>(runs.size());
    for (const Quantity& quantity : quantities()) {
        const std::vector<double> values = values_of(runs, quantity.number);
        if (values.empty()) {
            row.entries.emplace_back();
            continue;
        }
        const evaluation::Interval mean = evaluation::mean_over_runs(values);
        row.entries.push_back({mean.value, mean.low, mean.high});
    }
    return row;
}

evaluation::CurveBin bin_of(double distance_mm, std::vector<double> values) {
    std::sort(values.begin(), values.end());
    const auto at = [&](double fraction) { return evaluation::percentile(values, fraction); };
    return {distance_mm, static_cast<int>(values.size()), at(0.5), at(0.25), at(0.75), at(0.95)};
}

// One curve a generator, over the distance.
tables::CurveSet curves_of(const std::string& title, const std::string& number, const std::string& y_title,
                           const std::vector<ViewCell>& cells,
                           const std::vector<std::vector<std::vector<NamedNumber>>>& runs) {
    tables::CurveSet set{title, "distance [mm]", y_title, false, {}};
    for (std::size_t i = 0; i < cells.size(); ++i) {
        const std::vector<double> values = values_of(runs[i], number);
        if (values.empty()) continue;
        const std::string name = generator_name(cells[i]);
        auto curve = std::find_if(set.curves.begin(), set.curves.end(), [&](const auto& c) { return c.label == name; });
        if (curve == set.curves.end()) curve = set.curves.insert(set.curves.end(), {name, {}});
        curve->bins.push_back(bin_of(cells[i].distance_mm, values));
    }
    for (evaluation::Curve& curve : set.curves) {
        std::sort(curve.bins.begin(), curve.bins.end(), [](const auto& a, const auto& b) { return a.x < b.x; });
    }
    return set;
}

}  // namespace

void validate(const ViewTableOptions& options) {
    check_option("seeds", options.seeds, 1, 1e6);
    if (options.distances_mm.empty()) throw std::invalid_argument("no distance to compare views at");
    if (options.samples.empty()) throw std::invalid_argument("no number of samples to compare views with");
    for (const ViewCell& cell : rows_of(options)) validate(cell);
}

std::vector<ViewCell> rows_of(const ViewTableOptions& options) {
    std::vector<ViewCell> rows;
    for (const double distance_mm : options.distances_mm) {
        for (const std::string& views : options.views) {
            ViewCell cell;
            cell.views = views;
            cell.distance_mm = distance_mm;
            cell.max_rays = options.max_rays;
            for (const int samples : options.samples) {
                cell.view_samples = samples;
                rows.push_back(cell);
                if (views == "raycast") break;
            }
        }
    }
    return rows;
}

tables::Table view_table(const ViewBench& bench, const ViewTableOptions& options,
                         const std::function<bool()>& row_done) {
    validate(options);
    const std::vector<ViewCell> cells = rows_of(options);
    std::vector<std::vector<std::vector<NamedNumber>>> runs(cells.size());
    std::atomic<bool> stopped = false;
    std::mutex mutex;
    parallel_for(static_cast<int>(cells.size()), options.num_threads, [&](int i) {
        if (stopped) return;
        const auto row = static_cast<std::size_t>(i);
        runs[row] = runs_of(bench, cells[row], options.seeds);
        const std::lock_guard lock(mutex);
        if (!row_done()) stopped = true;
    });

    tables::Table table;
    table.name = "views";
    table.title = "Views alone";
    table.text =
        "Points of views against what a camera at the pose sees. Wrongly visible: the share of a view's points that "
        "are not the first surface on their own ray. Missing: the share of the grid's rays that meet the part and have "
        "no right point. Off the surface: distance of the points from the surface that is seen.";
    for (const Quantity& quantity : quantities()) table.columns.push_back(quantity.column);
    for (std::size_t i = 0; i < cells.size(); ++i) {
        if (!runs[i].empty()) table.rows.push_back(row_of(cells[i], runs[i]));
    }
    table.curve_sets.push_back(curves_of("Points wrongly visible", "wrong_percent", "of the points [%]", cells, runs));
    table.curve_sets.push_back(
        curves_of("Pixels without a point", "missing_percent", "of the pixels [%]", cells, runs));
    return table;
}

}  // namespace nearpose::compare
