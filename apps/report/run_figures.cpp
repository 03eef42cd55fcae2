#include "apps/report/run_figures.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "apps/runs/verdict_tally.hpp"

namespace nearpose::report {
namespace {

using Json = nlohmann::ordered_json;
using evaluation::FrameErrors;

Json statistics_json(const evaluation::Statistics& statistics) {
    if (statistics.count == 0) return nullptr;
    return {{"mean", statistics.mean},
            {"median", statistics.median},
            {"percentile_95", statistics.percentile_95},
            {"max", statistics.max}};
}

Json arrival_json(const evaluation::Arrival& arrival, const std::vector<FrameErrors>& errors,
                  const evaluation::ErrorLimit& limit) {
    const auto frame = [&](const std::optional<int>& index) {
        return index ? Json(errors[*index].frame_id) : Json(nullptr);
    };
    return {{"within_mm", 1e3 * limit.translation_m},
            {"within_deg", 180.0 / std::numbers::pi * limit.rotation_rad},
            {"first_frame", frame(arrival.first_index)},
            {"holds_from_frame", frame(arrival.holds_from)},
            {"stays", arrival.stays()}};
}

data_set::ModelInfo info_of(const RunInput& input) {
    if (input.model_info) return *input.model_info;
    const ModelExtent extent = extent_of(input.mesh);
    data_set::ModelInfo info;
    info.diameter_m = extent.diameter_m();
    info.box_min_in_object_m = extent.box_min_in_object;
    info.box_max_in_object_m = extent.box_max_in_object;
    return info;
}

evaluation::Statistics times_ms(const RunInput& input) {
    std::vector<double> values;
    for (const LoggedFrame& frame : input.log) {
        if (frame.time_s >= 0.0) values.push_back(1e3 * frame.time_s);
    }
    return evaluation::statistics_of(values);
}

int count_of(const RunInput& input, const std::string& status) {
    int count = 0;
    for (const LoggedFrame& frame : input.log) count += frame.status == status ? 1 : 0;
    return count;
}

// null where no frame has a verdict.
Json verdicts_json(const std::vector<LoggedFrame>& log) {
    std::vector<program::JudgedFrame> judged;
    for (const LoggedFrame& frame : log) {
        if (!frame.verdict) continue;
        program::JudgedFrame& added = judged.emplace_back(program::JudgedFrame{frame.frame_id, *frame.verdict, {}});
        for (const LoggedLack& lack : frame.missing) added.missing.push_back(lack.requirement);
    }
    if (judged.empty()) return nullptr;
    const program::VerdictTally tally = program::tally_of(judged);
    Json lacks = Json::array();
    for (const program::Lack& lack : tally.lacks)
        lacks.push_back({{"requirement", lack.requirement},
                         {"title", program::title_of(lack.requirement)},
                         {"advice", program::advice_for(lack.requirement)},
                         {"frames", lack.frames},
                         {"first_frame", lack.first_frame}});
    return {{"frames", tally.frames},
            {"accept", tally.accepts},
            {"continue", tally.continues},
            {"lost", tally.lost},
            {"lacks", lacks}};
}

}  // namespace

std::vector<FrameErrors> errors_of_run(const RunInput& input) {
    std::vector<FrameErrors> errors;
    const evaluation::ModelShape shape = evaluation::shape_of(info_of(input), input.mesh);
    for (std::size_t i = 0; i < input.log.size(); ++i) {
        const LoggedFrame& frame = input.log[i];
        const auto truth = input.truth.find(frame.frame_id);
        if (truth == input.truth.end()) {
            errors.emplace_back().frame_id = frame.frame_id;
            continue;
        }
        std::optional<evaluation::EstimatedFrame> estimate;
        if (frame.camera_from_object) {
            estimate = {*frame.camera_from_object, frame.score.value_or(0.0), frame.time_s, frame.status == "predicted",
                        frame.covariance};
        }
        errors.push_back(evaluation::frame_errors({frame.frame_id, truth->second, std::nullopt}, estimate, shape,
                                                  input.source->frames()[input.frame_in_source[i]].camera));
    }
    return errors;
}

Json figures_json(const RunInput& input, const std::vector<FrameErrors>& errors, int burn_in) {
    Json figures = {{"frames", input.log.size()},
                    {"estimated", count_of(input, "estimated")},
                    {"predicted", count_of(input, "predicted")},
                    {"without_pose", count_of(input, "no_pose")},
                    {"time_ms", statistics_json(times_ms(input))},
                    {"verdicts", verdicts_json(input.log)}};
    if (input.truth.empty()) return figures;
    evaluation::SummaryOptions options;
    // A run that is hardly longer than the burn-in still has figures.
    options.burn_in = static_cast<int>(errors.size()) > burn_in + 5 ? burn_in : static_cast<int>(errors.size()) / 3;
    const evaluation::RunSummary summary = evaluation::summarise(errors, info_of(input).diameter_m, options);
    figures["burn_in"] = options.burn_in;
    figures["lost"] = summary.frames_lost;
    figures["translation_mm"] = statistics_json(summary.translation_mm);
    figures["rotation_deg"] = statistics_json(summary.rotation_deg);
    Json axes = Json::array();
    for (int axis = 0; axis < 3; ++axis) {
        axes.push_back({{"translation_mm", statistics_json(summary.translation_axis_mm[axis])},
                        {"rotation_deg", statistics_json(summary.rotation_axis_deg[axis])}});
    }
    figures["axes"] = axes;
    figures["add_s_mm"] = statistics_json(summary.add_s_mm);
    figures["coarse"] = arrival_json(summary.coarse, errors, options.coarse);
    figures["fine"] = arrival_json(summary.fine, errors, options.fine);
    if (summary.inside_90) figures["inside_90"] = *summary.inside_90;
    return figures;
}

Sigma sigma_of(const Matrix6d& covariance, const Eigen::Vector3d& centre_in_object) {
    // The centre moves by translation + rotation x centre, in object axes.
    Eigen::Matrix<double, 3, 6> motion;
    for (int axis = 0; axis < 3; ++axis) motion.col(axis) = Eigen::Vector3d::Unit(axis).cross(centre_in_object);
    motion.rightCols<3>().setIdentity();
    const double translation = (motion * covariance * motion.transpose()).trace();
    const double rotation = covariance.topLeftCorner<3, 3>().trace();
    return {1e3 * std::sqrt(std::max(translation, 0.0)), 180.0 / std::numbers::pi * std::sqrt(std::max(rotation, 0.0))};
}

}  // namespace nearpose::report
