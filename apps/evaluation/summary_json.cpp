#include <nlohmann/json.hpp>
#include <numbers>

#include "apps/evaluation/summary_text.hpp"

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
    json["time_ms"] = json_of(summary.time_ms);
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace nearpose::evaluation
