#include "apps/evaluate/summary_text.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "apps/base/degrees.hpp"
#include "apps/base/number_text.hpp"

namespace nearpose::evaluation {
namespace {

using data_set::format_fixed;
using data_set::format_number;

constexpr std::size_t kLabelWidth = 24, kColumnWidth = 10;

std::string padded(const std::string& text, std::size_t width = kColumnWidth) {
    return text.size() < width ? std::string(width - text.size(), ' ') + text : text;
}

std::string labelled(const std::string& label) {
    return label + std::string(kLabelWidth - std::min(kLabelWidth, label.size()), ' ');
}

std::string row(const std::string& label, const Statistics& statistics, int decimals = 3) {
    std::string text = labelled(label);
    for (const double value : {statistics.mean, statistics.standard_deviation, statistics.median,
                               statistics.percentile_95, statistics.max}) {
        text += padded(format_fixed(value, decimals));
    }
    return text + "\n";
}

std::string percent(double share) {
    return format_fixed(100.0 * share, 1) + " %";
}

std::string errors_text(const RunSummary& summary) {
    std::string text = labelled("");
    for (const char* title : {"mean", "std dev", "median", "95 %", "max"}) text += padded(title);
    text += "\n" + row("translation [mm]", summary.translation_mm);
    constexpr std::array kAxes = {"x", "y", "z"};
    for (std::size_t i = 0; i < 3; ++i) {
        text += row(std::string("  along ") + kAxes[i] + " [mm]", summary.translation_axis_mm[i]);
    }
    text += row("rotation [deg]", summary.rotation_deg);
    for (std::size_t i = 0; i < 3; ++i) {
        text += row(std::string("  about ") + kAxes[i] + " [deg]", summary.rotation_axis_deg[i]);
    }
    text += row("ADD [mm]", summary.add_mm) + row("ADD-S [mm]", summary.add_s_mm);
    return text + row("MSSD [mm]", summary.mssd_mm) + row("MSPD [px]", summary.mspd_px);
}

std::string areas_text(const RunSummary& summary, double model_diameter_m) {
    const std::string tenth = format_fixed(100.0 * model_diameter_m, 1);
    return labelled("AUC to 100 mm") + "ADD " + percent(summary.add_auc) + ", ADD-S " + percent(summary.add_s_auc) +
           "\n" + labelled("AUC to 0.1 diameters") + "ADD " + percent(summary.add_auc_diameter) + ", ADD-S " +
           percent(summary.add_s_auc_diameter) + " (to " + tenth + " mm)\n";
}

std::string limit_name(double translation_m, double rotation_rad) {
    // Six digits drop what the way to radians and back left behind.
    const auto rounded = [](double value) { return format_number(std::round(value * 1e6) / 1e6); };
    return rounded(1e3 * translation_m) + " mm and " + rounded(kDegrees * rotation_rad) + " deg";
}

std::string arrival_text(const std::vector<FrameErrors>& frames, const ErrorLimit& limit, const Arrival& arrival) {
    const auto frame_of = [&](int index) { return std::to_string(frames[static_cast<std::size_t>(index)].frame_id); };
    const std::string name = "within " + limit_name(limit.translation_m, limit.rotation_rad) + ": ";
    if (!arrival.first_index) return name + "never\n";
    const std::string text = name + "first in frame " + frame_of(*arrival.first_index);
    if (!arrival.holds_from) return text + ", but not in the last frame\n";
    return text + (arrival.stays() ? ", and in every frame from there on\n"
                                   : ", for good from frame " + frame_of(*arrival.holds_from) + " on\n");
}

std::string lost_text(const std::vector<FrameErrors>& frames, const RunSummary& summary) {
    if (!summary.coarse.first_index) return "";
    const int after = static_cast<int>(frames.size()) - *summary.coarse.first_index - 1;
    return "lost after the first arrival: " + std::to_string(summary.frames_lost) + " of " + std::to_string(after) +
           " frames\n";
}

std::string covariance_text(const RunSummary& summary) {
    if (!summary.inside_90) return "";
    const int frames = summary.frames_with_covariance;
    const Interval interval = proportion(static_cast<int>(std::lround(*summary.inside_90 * frames)), frames);
    std::string text = "truth inside the 90 % region: " + percent(interval.value) + " of " + std::to_string(frames) +
                       " frames (95 % interval " + percent(interval.low) + " to " + percent(interval.high) + ")";
    if (summary.inside_90_rotation) text += "; rotation alone " + percent(*summary.inside_90_rotation);
    if (summary.inside_90_translation) text += ", translation alone " + percent(*summary.inside_90_translation);
    return text + "\n";
}

std::string coverage_row(const std::string& label, const Coverage& coverage) {
    std::string text = labelled("  " + label);
    for (std::size_t level = 0; level < kCoverageLevels.size(); ++level) text += padded(percent(coverage.share(level)));
    const Interval of_90 = proportion(coverage.inside[1], coverage.frames);
    return text + padded(std::to_string(coverage.frames)) + "   " + percent(of_90.low) + " to " + percent(of_90.high) +
           "\n";
}

// A table by distance, of the frames after the burn-in.
std::string coverage_text(const RunSummary& summary) {
    if (summary.coverage_by_distance.empty()) return "";
    std::string text = labelled("inside the region of");
    for (const double level : kCoverageLevels) text += padded(format_number(100.0 * level) + " %");
    text += padded("frames") + "   of 90 %: 95 % interval\n";
    for (const CoverageBin& bin : summary.coverage_by_distance) {
        text += coverage_row(format_fixed(1e3 * bin.from_m, 0) + " to " + format_fixed(1e3 * bin.to_m, 0) + " mm",
                             bin.coverage);
    }
    return text + coverage_row("all distances", summary.coverage);
}

std::string of_some(int part, int all) {
    return std::to_string(part) + " of " + std::to_string(all);
}

std::string verdicts_text(const RunSummary& summary, const Tolerance& tolerance) {
    const VerdictCounts& counts = summary.verdicts;
    if (counts.frames == 0) return "";
    std::string text = "verdicts of " + std::to_string(counts.frames) + " frames: " + std::to_string(counts.accepts) +
                       " accept, " + std::to_string(counts.continues) + " continue, " + std::to_string(counts.lost) +
                       " lost; tolerance " + limit_name(tolerance.translation_m, tolerance.rotation_rad) + "\n";
    text += "accepted but beyond the tolerance: " + of_some(counts.false_accepts, counts.accepts);
    if (counts.accepts > 0) {
        const Interval share = proportion(counts.false_accepts, counts.accepts);
        text += " (95 % interval " + percent(share.low) + " to " + percent(share.high) + ")";
    }
    return text + "; lost though within it: " + of_some(counts.missed, counts.lost) + "\n";
}

}  // namespace

std::string summary_text(const SummaryHeading& heading, const std::vector<FrameErrors>& frames,
                         const RunSummary& summary, const SummaryOptions& options) {
    std::string text = "object " + std::to_string(heading.object_id) + " in " + heading.scene + ": " +
                       std::to_string(summary.frames) + " frames, " + std::to_string(summary.frames_without_pose) +
                       " without a pose, " + std::to_string(summary.frames_predicted) + " predicted\n";
    const std::size_t burn_in = static_cast<std::size_t>(std::max(options.burn_in, 0));
    if (burn_in < frames.size()) {
        text += "frames " + std::to_string(frames[burn_in].frame_id) + " to " + std::to_string(frames.back().frame_id) +
                (burn_in > 0 ? " (those before are the burn-in)" : "") + ", camera axes, at the centre of the box\n";
    }
    if (summary.translation_mm.count == 0) {
        text += "no frame with a pose after the burn-in\n";
    } else {
        text += errors_text(summary);
    }
    if (summary.time_ms.count > 0) text += row("time a frame [ms]", summary.time_ms, 1);
    if (summary.translation_mm.count > 0) text += areas_text(summary, heading.model_diameter_m);
    return text + arrival_text(frames, options.coarse, summary.coarse) +
           arrival_text(frames, options.fine, summary.fine) + lost_text(frames, summary) + covariance_text(summary) +
           coverage_text(summary) + verdicts_text(summary, options.tolerance);
}

}  // namespace nearpose::evaluation
