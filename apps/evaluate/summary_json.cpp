#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "apps/base/number_text.hpp"
#include "apps/evaluate/summary_text.hpp"

namespace nearpose::evaluation {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const Statistics& statistics) {
    if (statistics.count == 0) return nullptr;
    return {{"count", statistics.count},
            {"mean", statistics.mean},
            {"standard_deviation", statistics.standard_deviation},
            {"median", statistics.median},
            {"percentile_95", statistics.percentile_95},
            {"max", statistics.max}};
}

Json json_of(const Statistics (&axes)[3]) {
    return {{"x", json_of(axes[0])}, {"y", json_of(axes[1])}, {"z", json_of(axes[2])}};
}

Json json_of(const std::optional<double>& value) {
    return value ? Json(*value) : Json(nullptr);
}

Json json_of(const Arrival& arrival, const ErrorLimit& limit, const std::vector<FrameErrors>& frames) {
    const auto frame_of = [&](const std::optional<int>& index) {
        return index ? Json(frames[static_cast<std::size_t>(*index)].frame_id) : Json(nullptr);
    };
    return {{"limit_mm", 1e3 * limit.translation_m},
            {"limit_deg", 180.0 / std::numbers::pi * limit.rotation_rad},
            {"first_frame", frame_of(arrival.first_index)},
            {"holds_from_frame", frame_of(arrival.holds_from)},
            {"stays", arrival.stays()}};
}

Json json_of(const Coverage& coverage) {
    Json json = {{"frames", coverage.frames}};
    for (std::size_t level = 0; level < kCoverageLevels.size(); ++level) {
        const std::string name = "inside_" + data_set::format_number(100.0 * kCoverageLevels[level]);
        json[name] = coverage.frames > 0 ? Json(coverage.share(level)) : Json(nullptr);
    }
    if (coverage.frames == 0) return json;
    const Interval of_90 = proportion(coverage.inside[1], coverage.frames);
    json["inside_90_interval_95"] = {of_90.low, of_90.high};
    return json;
}

Json json_of(const std::vector<CoverageBin>& bins) {
    Json list = Json::array();
    const auto rounded = [](double value_m) { return std::round(1e9 * value_m) / 1e6; };  // to a nanometre, in mm
    for (const CoverageBin& bin : bins) {
        Json json = {{"from_mm", rounded(bin.from_m)}, {"to_mm", rounded(bin.to_m)}};
        json.update(json_of(bin.coverage));
        list.push_back(json);
    }
    return list;
}

// null where no frame has a verdict.
Json json_of(const VerdictCounts& counts, const Tolerance& tolerance, const std::vector<FrameErrors>& frames) {
    if (counts.frames == 0) return nullptr;
    const std::optional<int>& first = counts.first_right_accept;
    return {{"frames", counts.frames},
            {"accept", counts.accepts},
            {"continue", counts.continues},
            {"lost", counts.lost},
            {"false_accepts", counts.false_accepts},
            {"missed", counts.missed},
            {"first_right_accept_frame", first ? Json(frames[static_cast<std::size_t>(*first)].frame_id) : nullptr},
            {"tolerance_mm", 1e3 * tolerance.translation_m},
            {"tolerance_deg", 180.0 / std::numbers::pi * tolerance.rotation_rad}};
}

}  // namespace

std::string summary_json(const SummaryHeading& heading, const std::vector<FrameErrors>& frames,
                         const RunSummary& summary, const SummaryOptions& options) {
    Json json = {{"format", 1},
                 {"content", "nearpose evaluate"},
                 {"scene", heading.scene},
                 {"results", heading.results},
                 {"scene_id", heading.scene_id},
                 {"object_id", heading.object_id},
                 {"diameter_mm", 1e3 * heading.model_diameter_m},
                 {"burn_in", options.burn_in},
                 {"frames", summary.frames},
                 {"frames_without_pose", summary.frames_without_pose},
                 {"frames_predicted", summary.frames_predicted},
                 {"frames_lost", summary.frames_lost}};
    json["translation_mm"] = json_of(summary.translation_mm);
    json["translation_axis_mm"] = json_of(summary.translation_axis_mm);
    json["rotation_deg"] = json_of(summary.rotation_deg);
    json["rotation_axis_deg"] = json_of(summary.rotation_axis_deg);
    json["add_mm"] = json_of(summary.add_mm);
    json["add_s_mm"] = json_of(summary.add_s_mm);
    json["mssd_mm"] = json_of(summary.mssd_mm);
    json["mspd_px"] = json_of(summary.mspd_px);
    json["add_auc"] = summary.add_auc;
    json["add_s_auc"] = summary.add_s_auc;
    json["add_auc_diameter"] = summary.add_auc_diameter;
    json["add_s_auc_diameter"] = summary.add_s_auc_diameter;
    json["coarse"] = json_of(summary.coarse, options.coarse, frames);
    json["fine"] = json_of(summary.fine, options.fine, frames);
    json["frames_with_covariance"] = summary.frames_with_covariance;
    json["inside_90"] = json_of(summary.inside_90);
    json["inside_90_rotation"] = json_of(summary.inside_90_rotation);
    json["inside_90_translation"] = json_of(summary.inside_90_translation);
    json["coverage"] = json_of(summary.coverage);
    json["coverage_by_distance"] = json_of(summary.coverage_by_distance);
    json["verdicts"] = json_of(summary.verdicts, options.tolerance, frames);
    json["time_ms"] = json_of(summary.time_ms);
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace nearpose::evaluation
