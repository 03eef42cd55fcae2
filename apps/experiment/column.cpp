#include "apps/experiment/column.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace nearpose::experiment {
namespace {

using evaluation::RunSummary;
using evaluation::Statistics;

enum class Pooling { kMean, kMedian, kShare, kMedianTime };

struct ColumnRule {
    std::string name, figure;
    Pooling pooling = Pooling::kMean;
    std::string among = {};  // the figure that is 1 for the runs that count; empty: all
    double scale = 1.0;
    tables::Column heading = {};
};

struct ErrorKind {
    const char *name, *title, *unit;
};
constexpr ErrorKind kErrors[] = {{"translation", "translation", "mm"},
                                 {"rotation", "rotation", "deg"},
                                 {"translation_x", "translation x", "mm"},
                                 {"translation_y", "translation y", "mm"},
                                 {"translation_z", "translation z", "mm"},
                                 {"rotation_x", "rotation x", "deg"},
                                 {"rotation_y", "rotation y", "deg"},
                                 {"rotation_z", "rotation z", "deg"},
                                 {"add", "ADD", "mm"},
                                 {"add_s", "ADD-S", "mm"},
                                 {"mssd", "MSSD", "mm"},
                                 {"mspd", "MSPD", "px"}};

void add_error_columns(const ErrorKind& error, std::vector<ColumnRule>& rules) {
    const std::string name = error.name, title = error.title;
    const std::pair<const char*, const char*> statistics[] = {
        {"mean", ""}, {"sd", ", sd"}, {"p95", ", 95 %"}, {"max", ", max"}};
    for (const auto& [statistic, suffix] : statistics) {
        const std::string figure = name + "_" + statistic;
        rules.push_back({figure, figure, Pooling::kMean, "", 1.0, {title + suffix, error.unit, 2}});
        for (const char* among : {"held", "converged"}) {
            rules.push_back({figure + "_" + among,
                             figure,
                             Pooling::kMean,
                             among,
                             1.0,
                             {title + suffix + " (" + among + ")", error.unit, 2}});
        }
    }
    rules.push_back(
        {name + "_median", name + "_mean", Pooling::kMedian, "", 1.0, {title + ", median run", error.unit, 2}});
}

std::vector<ColumnRule> run_columns() {
    std::vector<ColumnRule> rules;
    for (const ErrorKind& error : kErrors) add_error_columns(error, rules);
    rules.push_back({"depth_mean", "depth_mean", Pooling::kMean, "", 1.0, {"depth, signed", "mm", 2}});
    const auto add_share = [&](const char* name, const char* title) {
        rules.push_back({name, name, Pooling::kShare, "", 100.0, {title, "%", 0}});
    };
    add_share("arrives", "runs that arrive");
    add_share("stays", "arrive and stay");
    add_share("held", "held after burn-in");
    add_share("first_within_3", "within 10 mm, 5 deg in frames 0-2");
    add_share("converged", "converged");
    add_share("arrives_fine", "within 2 mm, 1 deg");
    const auto add_frames = [&](const char* name, const char* title) {
        rules.push_back({name, name, Pooling::kMedianTime, "", 1.0, {title, "frames", 0}});
    };
    add_frames("frames_to_arrive", "until arrival");
    add_frames("frames_to_hold", "until it holds");
    add_frames("frames_to_fine", "until 2 mm, 1 deg");
    add_frames("frames_to_refind", "until found again");
    add_frames("first_accept", "until the first right accept");
    add_frames("frames_to_recover", "from the fault's end to a right accept");
    rules.push_back({"accepted_wrong", "accepted_wrong", Pooling::kMean, "", 1.0, {"accepted wrong", "frames", 1}});
    const auto add_percent = [&](const char* name, const char* title) {
        rules.push_back({name, name, Pooling::kMean, "", 100.0, {title, "%", 1}});
    };
    add_percent("lost", "frames lost");
    add_percent("without_pose", "frames without pose");
    add_percent("predicted", "frames predicted");
    add_percent("accepted", "frames accepted");
    add_percent("accepted_of_right", "accepted of the right");
    add_percent("false_accepts", "falsely accepted");
    add_percent("false_accepts_of_accepts", "false among accepts");
    add_percent("lost_verdicts", "verdict lost");
    add_percent("add_auc", "AUC of ADD");
    add_percent("add_s_auc", "AUC of ADD-S");
    add_percent("add_auc_diameter", "AUC of ADD, 0.1 d");
    add_percent("add_s_auc_diameter", "AUC of ADD-S, 0.1 d");
    add_percent("inside_90", "in the 90 % region");
    add_percent("inside_90_rotation", "in the 90 % region, rotation");
    add_percent("inside_90_translation", "in the 90 % region, translation");
    rules.push_back({"cpu_ms", "cpu_ms", Pooling::kMean, "", 1.0, {"CPU a frame, median", "ms", 1}});
    rules.push_back({"cpu_ms_mean", "cpu_ms_mean", Pooling::kMean, "", 1.0, {"CPU a frame, mean", "ms", 1}});
    return rules;
}

// As compare::ViewBench::numbers names them.
std::vector<ColumnRule> view_columns() {
    const std::pair<const char*, tables::Column> columns[] = {
        {"points_per_view", {"points a view", "", 0}},
        {"pixels_per_view", {"pixels a view", "", 0}},
        {"wrong_percent", {"wrongly visible", "%", 2}},
        {"hidden_percent", {"hidden", "%", 2}},
        {"missing_percent", {"missing", "%", 2}},
        {"mean_distance_mm", {"off the surface, mean", "mm", 3}},
        {"distance_95_mm", {"off the surface, 95 %", "mm", 3}},
        {"max_distance_mm", {"off the surface, max", "mm", 2}},
        {"cpu_ms_per_200_views", {"CPU for 200 views", "ms", 1}},
        {"raycast_cpu_ms_per_200_views", {"CPU for 200 cast views", "ms", 1}},
        {"cpu_ratio_to_raycast", {"CPU, of ray casting's", "", 2}}};
    std::vector<ColumnRule> rules;
    for (const auto& [name, heading] : columns) rules.push_back({name, name, Pooling::kMean, "", 1.0, heading});
    return rules;
}

const std::vector<ColumnRule>& rules_of(TableKind kind) {
    static const std::vector<ColumnRule> runs = run_columns(), views = view_columns();
    return kind == TableKind::kRun ? runs : views;
}

const ColumnRule& rule_named(TableKind kind, const std::string& name) {
    for (const ColumnRule& rule : rules_of(kind)) {
        if (rule.name == name) return rule;
    }
    throw std::out_of_range("no column " + name);
}

tables::Entry scaled(const tables::Entry& entry, double scale) {
    const auto times = [scale](const std::optional<double>& value) {
        return value ? std::optional(*value * scale) : std::nullopt;
    };
    return {times(entry.value), times(entry.low), times(entry.high)};
}

tables::Entry mean_of(const std::vector<double>& values) {
    if (values.empty()) return {};
    if (values.size() == 1) return {values.front(), {}, {}};
    const evaluation::Interval mean = evaluation::mean_over_runs(values);
    return {mean.value, mean.low, mean.high};
}

tables::Entry share_of(const std::vector<double>& values) {
    if (values.empty()) return {};
    const auto yes = std::count(values.begin(), values.end(), 1.0);
    const evaluation::Interval share = evaluation::proportion(static_cast<int>(yes), static_cast<int>(values.size()));
    return {share.value, share.low, share.high};
}

void add_statistics(const std::string& name, const Statistics& statistics, Figures& figures) {
    if (statistics.count == 0) return;  // no frame with a pose: an error of 0 would be a lie
    figures[name + "_mean"] = statistics.mean;
    figures[name + "_sd"] = statistics.standard_deviation;
    figures[name + "_p95"] = statistics.percentile_95;
    figures[name + "_max"] = statistics.max;
}

void add_errors(const RunSummary& summary, Figures& figures) {
    add_statistics("translation", summary.translation_mm, figures);
    add_statistics("rotation", summary.rotation_deg, figures);
    const char* axes[] = {"x", "y", "z"};
    for (int axis = 0; axis < 3; ++axis) {
        add_statistics(std::string("translation_") + axes[axis], summary.translation_axis_mm[axis], figures);
        add_statistics(std::string("rotation_") + axes[axis], summary.rotation_axis_deg[axis], figures);
    }
    if (summary.depth_mm.count > 0) figures["depth_mean"] = summary.depth_mm.mean;
    add_statistics("add", summary.add_mm, figures);
    add_statistics("add_s", summary.add_s_mm, figures);
    add_statistics("mssd", summary.mssd_mm, figures);
    add_statistics("mspd", summary.mspd_px, figures);
    if (summary.frames_shown == 0) return;
    figures["add_auc"] = summary.add_auc;
    figures["add_s_auc"] = summary.add_s_auc;
    figures["add_auc_diameter"] = summary.add_auc_diameter;
    figures["add_s_auc_diameter"] = summary.add_s_auc_diameter;
    if (summary.inside_90) figures["inside_90"] = *summary.inside_90;
    if (summary.inside_90_rotation) figures["inside_90_rotation"] = *summary.inside_90_rotation;
    if (summary.inside_90_translation) figures["inside_90_translation"] = *summary.inside_90_translation;
}

// None for a run that never shows the part: there is nothing to arrive at.
void add_arrivals(const RunSummary& summary, const evaluation::SummaryOptions& options, Figures& figures) {
    if (summary.frames_shown == 0) return;
    const auto flag = [](bool value) { return value ? 1.0 : 0.0; };
    const evaluation::Arrival& coarse = summary.coarse;
    figures["arrives"] = flag(coarse.first_index.has_value());
    figures["first_within_3"] = flag(coarse.first_index && *coarse.first_index < 3);
    figures["stays"] = flag(coarse.stays());
    figures["held"] = flag(summary.held);
    figures["converged"] =
        flag(summary.translation_mm.count > 0 && summary.translation_mm.median <= 1e3 * options.coarse.translation_m &&
             summary.rotation_deg.median <= options.coarse.rotation_rad * 180.0 / M_PI);
    figures["arrives_fine"] = flag(summary.fine.first_index.has_value());
    // The number of frames up to and with the one that is there.
    if (coarse.first_index) figures["frames_to_arrive"] = *coarse.first_index + 1;
    if (coarse.holds_from) figures["frames_to_hold"] = *coarse.holds_from + 1;
    if (summary.fine.first_index) figures["frames_to_fine"] = *summary.fine.first_index + 1;
    if (summary.frames_to_refind) figures["frames_to_refind"] = *summary.frames_to_refind;
    if (summary.frames_after_arrival > 0)
        figures["lost"] = summary.frames_lost / static_cast<double>(summary.frames_after_arrival);
}

void add_verdicts(const evaluation::VerdictCounts& verdicts, Figures& figures) {
    if (verdicts.frames == 0) return;
    const double frames = verdicts.frames;
    figures["accepted"] = verdicts.accepts / frames;
    figures["false_accepts"] = verdicts.false_accepts / frames;
    figures["lost_verdicts"] = verdicts.lost / frames;
    figures["accepted_wrong"] = verdicts.false_accepts;
    if (verdicts.accepts > 0)
        figures["false_accepts_of_accepts"] = verdicts.false_accepts / static_cast<double>(verdicts.accepts);
    if (verdicts.well_within > 0)
        figures["accepted_of_right"] = verdicts.well_within_accepts / static_cast<double>(verdicts.well_within);
    if (verdicts.frames_to_recover) figures["frames_to_recover"] = *verdicts.frames_to_recover;
    if (verdicts.first_right_accept) figures["first_accept"] = *verdicts.first_right_accept + 1;
}

}  // namespace

Figures figures_of(const RunSummary& summary, const evaluation::SummaryOptions& options) {
    Figures figures;
    add_errors(summary, figures);
    add_arrivals(summary, options, figures);
    add_verdicts(summary.verdicts, figures);
    const double frames = std::max(1, summary.frames);
    figures["without_pose"] = summary.frames_without_pose / frames;
    figures["predicted"] = summary.frames_predicted / frames;
    return figures;
}

std::vector<std::string> column_names(TableKind kind) {
    std::vector<std::string> names;
    for (const ColumnRule& rule : rules_of(kind)) names.push_back(rule.name);
    return names;
}

tables::Column heading_of(TableKind kind, const std::string& name) {
    return rule_named(kind, name).heading;
}

tables::Entry median_of(std::vector<double> values) {
    if (values.empty()) return {};
    std::sort(values.begin(), values.end());
    const auto finite = [](double value) { return std::isfinite(value) ? std::optional(value) : std::nullopt; };
    const std::size_t n = values.size(), middle = n / 2;
    tables::Entry entry;
    entry.value = finite(n % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]));
    // Ranks k and n + 1 - k enclose the median unless fewer than k values lie on one side of it: a binomial tail.
    double tail = 0.0, term = std::pow(0.5, static_cast<double>(n));
    std::size_t k = 0;
    while (k < middle && tail + term <= 0.025) {
        tail += term;
        term *= static_cast<double>(n - k) / static_cast<double>(k + 1);
        ++k;
    }
    if (k == 0) return entry;
    entry.low = finite(values[k - 1]);
    entry.high = finite(values[n - k]);
    return entry;
}

tables::Entry entry_of(TableKind kind, const std::string& name, const std::vector<Figures>& runs) {
    const ColumnRule& rule = rule_named(kind, name);
    std::vector<double> values;
    for (const Figures& run : runs) {
        const auto among = run.find(rule.among);
        if (!rule.among.empty() && (among == run.end() || among->second != 1.0)) continue;
        const auto found = run.find(rule.figure);
        if (found != run.end())
            values.push_back(found->second);
        else if (rule.pooling == Pooling::kMedianTime)
            values.push_back(std::numeric_limits<double>::infinity());
    }
    switch (rule.pooling) {
        case Pooling::kMean:
            return scaled(mean_of(values), rule.scale);
        case Pooling::kShare:
            return scaled(share_of(values), rule.scale);
        case Pooling::kMedian:
        case Pooling::kMedianTime:
            return scaled(median_of(values), rule.scale);
    }
    return {};
}

}  // namespace nearpose::experiment
