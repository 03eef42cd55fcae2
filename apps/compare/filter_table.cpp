#include "apps/compare/filter_table.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "apps/base/number_text.hpp"
#include "apps/error_measures/run_summary.hpp"

namespace nearpose::compare {
namespace {

using Frames = std::vector<evaluation::FrameErrors>;
using Value = std::optional<double> (*)(const evaluation::FrameErrors&);
using OfRun = double (*)(const std::vector<double>&);

constexpr int kBurnIn = 15;  // frames; of short runs a quarter

std::string label_of(const ComparedFilter& filter) {
    return filter.method + ", " + filter.views;
}

tables::Entry mean_entry(const std::vector<double>& value_of_run) {
    if (value_of_run.empty()) return {};
    const evaluation::Interval mean = evaluation::mean_over_runs(value_of_run);
    return {mean.value, mean.low, mean.high};
}

tables::Entry share_entry(int successes, int trials) {
    const evaluation::Interval share = evaluation::proportion(successes, trials);
    return {100.0 * share.value, 100.0 * share.low, 100.0 * share.high};
}

tables::Row run_row(const ComparedFilter& filter, const std::vector<Frames>& runs, double diameter_m) {
    std::vector<double> translation_mm, translation_95_mm, rotation_deg, frames_to_arrive, time_ms;
    int arrived = 0, held = 0;
    for (const Frames& frames : runs) {
        evaluation::SummaryOptions options;
        options.burn_in = std::min(kBurnIn, static_cast<int>(frames.size()) / 4);
        const evaluation::RunSummary run = evaluation::summarise(frames, diameter_m, options);
        if (run.translation_mm.count > 0) {
            translation_mm.push_back(run.translation_mm.mean);
            translation_95_mm.push_back(run.translation_mm.percentile_95);
            rotation_deg.push_back(run.rotation_deg.mean);
        }
        time_ms.push_back(run.time_ms.mean);
        if (run.coarse.first_index) frames_to_arrive.push_back(*run.coarse.first_index + 1);
        arrived += run.coarse.first_index ? 1 : 0;
        held += run.coarse.holds_from ? 1 : 0;
    }
    const int count = static_cast<int>(runs.size());
    return {label_of(filter),
            count,
            {mean_entry(translation_mm), mean_entry(translation_95_mm), mean_entry(rotation_deg),
             share_entry(arrived, count), share_entry(held, count), mean_entry(frames_to_arrive), mean_entry(time_ms)}};
}

// The listed distance that is nearest by ratio; of equally near ones the first.
std::size_t nearest_distance(const std::vector<double>& distances_mm, double distance_m) {
    std::size_t best = 0;
    const auto off = [&](std::size_t i) { return std::abs(std::log(distances_mm[i] / (1e3 * distance_m))); };
    for (std::size_t i = 1; i < distances_mm.size(); ++i) {
        if (off(i) < off(best)) best = i;
    }
    return best;
}

// Values of each run's frames near one of the distances.
std::vector<std::vector<double>> values_near(const std::vector<Frames>& runs, const FilterTableOptions& options,
                                             std::size_t distance, Value value) {
    std::vector<std::vector<double>> values;
    for (const Frames& frames : runs) {
        std::vector<double> of_run;
        for (const evaluation::FrameErrors& frame : frames) {
            const std::optional<double> distance_m = options.distance_of(frame);
            if (!distance_m || nearest_distance(options.distances_mm, *distance_m) != distance) continue;
            if (const auto known = value(frame)) of_run.push_back(*known);
        }
        if (!of_run.empty()) values.push_back(std::move(of_run));
    }
    return values;
}

std::optional<double> translation_mm(const evaluation::FrameErrors& frame) {
    if (!frame.errors) return std::nullopt;
    return 1e3 * frame.errors->translation_m;
}

std::optional<double> rotation_deg(const evaluation::FrameErrors& frame) {
    if (!frame.errors) return std::nullopt;
    return 180.0 / std::numbers::pi * frame.errors->rotation_rad;
}

std::optional<double> in_limit_percent(const evaluation::FrameErrors& frame) {
    return evaluation::within(frame, {}) ? 100.0 : 0.0;
}

double mean_of(const std::vector<double>& values) {
    return evaluation::statistics_of(values).mean;
}
double median_of(const std::vector<double>& values) {
    return evaluation::statistics_of(values).median;
}

tables::Table by_distance(const std::vector<ComparedFilter>& filters, const FilterResults& results,
                          const FilterTableOptions& options, Value value, OfRun of_run, const std::string& unit) {
    tables::Table table;
    for (const double distance_mm : options.distances_mm) {
        table.columns.push_back({"at " + data_set::format_number(distance_mm) + " mm", unit, 1});
    }
    for (std::size_t k = 0; k < filters.size(); ++k) {
        tables::Row row{label_of(filters[k]), static_cast<int>(results[k].size()), {}};
        for (std::size_t d = 0; d < options.distances_mm.size(); ++d) {
            std::vector<double> of_runs;
            for (const auto& values : values_near(results[k], options, d, value)) of_runs.push_back(of_run(values));
            row.entries.push_back(mean_entry(of_runs));
        }
        table.rows.push_back(std::move(row));
    }
    return table;
}

// Of one method's filters: more curves than that nobody can tell apart.
tables::CurveSet error_curves(const std::vector<ComparedFilter>& filters, const FilterResults& results,
                              const FilterTableOptions& options, const std::string& method, const std::string& quantity,
                              const std::string& unit, Value value) {
    constexpr int kBins = 10;
    constexpr double kMargin = 1.1;  // on either side, so that frames at the ends count
    const auto [low, high] = std::minmax_element(options.distances_mm.begin(), options.distances_mm.end());
    tables::CurveSet set{
        "Method " + method + ": " + quantity, options.distance_name + " [mm]", quantity + " [" + unit + "]", false, {}};
    for (std::size_t k = 0; k < filters.size(); ++k) {
        if (filters[k].method != method) continue;
        std::vector<evaluation::CurvePoint> points;
        for (const Frames& frames : results[k]) {
            for (const evaluation::FrameErrors& frame : frames) {
                const auto known = value(frame);
                const auto distance_m = options.distance_of(frame);
                if (distance_m && known) points.push_back({1e3 * *distance_m, *known});
            }
        }
        set.curves.push_back(evaluation::curve_of(filters[k].views, points, *low / kMargin, *high * kMargin, kBins));
    }
    return set;
}

}  // namespace

std::optional<double> visible_distance(const evaluation::FrameErrors& frame) {
    if (!frame.visibility || !(frame.visibility->distance_m > 0.0)) return std::nullopt;
    return frame.visibility->distance_m;
}

std::vector<tables::Table> filter_tables(const std::vector<ComparedFilter>& filters, const FilterResults& results,
                                         const FilterTableOptions& options) {
    tables::Table runs;
    runs.name = "filter";
    runs.title = "In the filter";
    runs.text =
        "Each filter gets the same frames and seeds and no start pose. Errors are of the frames after the burn-in; a "
        "run "
        "arrives when a frame is within 10 mm and 5 degrees, and holds when it is so at its end. CPU time is that of "
        "one "
        "thread in a whole update.";
    runs.columns = {{"translation error", "mm", 2},
                    {"95 %", "mm", 2},
                    {"rotation error", "deg", 2},
                    {"arrive", "%", 0},
                    {"hold", "%", 0},
                    {"frames to arrive", "", 1},
                    {"CPU a frame", "ms", 1}};
    // Diameters only scale figures that are not in the table.
    for (std::size_t k = 0; k < filters.size(); ++k) runs.rows.push_back(run_row(filters[k], results[k], 1.0));
    std::set<std::string> methods;
    for (const ComparedFilter& filter : filters) {
        if (!methods.insert(filter.method).second) continue;
        runs.curve_sets.push_back(
            error_curves(filters, results, options, filter.method, "translation error", "mm", translation_mm));
        runs.curve_sets.push_back(
            error_curves(filters, results, options, filter.method, "rotation error", "deg", rotation_deg));
    }

    tables::Table kept = by_distance(filters, results, options, in_limit_percent, mean_of, "%");
    kept.name = "filter_kept";
    kept.title = "In the filter, by distance: frames within 10 mm and 5 degrees";
    kept.text =
        "Share of the frames, mean over the runs. A frame counts for the distance that is nearest, by ratio, to the " +
        options.distance_name + ".";
    tables::Table errors = by_distance(filters, results, options, translation_mm, median_of, "mm");
    errors.name = "filter_errors";
    errors.title = "In the filter, by distance: translation error";
    errors.text =
        "Median of the frames of a run, mean over the runs. The first frames of a run count for the farthest.";
    return {runs, kept, errors};
}

}  // namespace nearpose::compare
