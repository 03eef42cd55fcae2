#include "apps/evaluate.hpp"

#include <CLI/CLI.hpp>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>

#include "apps/console.hpp"
#include "apps/data_set/bop_ground_truth.hpp"
#include "apps/data_set/bop_models.hpp"
#include "apps/data_set/file_io.hpp"
#include "apps/data_set/number_text.hpp"
#include "apps/data_set/result_csv.hpp"
#include "apps/evaluation/run_summary.hpp"
#include "apps/pictures/error_plot.hpp"

namespace nearpose::program {
namespace {

using evaluation::FrameErrors;

constexpr double kDegrees = 180.0 / std::numbers::pi;

struct EvaluateOptions {
    std::filesystem::path scene, models, results, out, plot;
    int object = 1;
    std::optional<int> scene_id, first, last;
    int burn_in = 10;
    double within_mm = 10.0, within_deg = 5.0;
};

// The number that the scene's folder is called, or that of --scene-id.
int scene_number(const EvaluateOptions& options) {
    if (options.scene_id) return *options.scene_id;
    std::filesystem::path folder = std::filesystem::absolute(options.scene).lexically_normal();
    if (!folder.has_filename()) folder = folder.parent_path();
    const auto number = data_set::parse_integer(folder.filename().string());
    if (!number) throw BadUse(options.scene.string() + ": the folder's name is no number; give --scene-id");
    return static_cast<int>(*number);
}

// Of several rows of one frame the one with the highest score counts.
std::map<int, data_set::PoseRow> rows_of_object(const EvaluateOptions& options) {
    const int scene_id = scene_number(options);
    const std::vector<data_set::PoseRow> rows = data_set::read_pose_csv(options.results);
    std::map<int, data_set::PoseRow> best;
    bool scene_found = false;
    for (const data_set::PoseRow& row : rows) {
        if (row.scene_id != scene_id) continue;
        scene_found = true;
        if (row.object_id != options.object) continue;
        const auto [place, added] = best.emplace(row.image_id, row);
        if (!added && row.score > place->second.score) place->second = row;
    }
    if (!scene_found) {
        throw std::runtime_error(options.results.string() + ": has no row of scene " + std::to_string(scene_id) +
                                 (rows.empty() ? "" : ", but of scene " + std::to_string(rows.front().scene_id)));
    }
    if (best.empty()) {
        throw std::runtime_error(options.results.string() + ": has no row of object " + std::to_string(options.object));
    }
    return best;
}

std::vector<FrameErrors> errors_of(const EvaluateOptions& options) {
    const data_set::ModelInfo model = data_set::read_model_info(options.models, options.object);
    const std::map<int, Pose> truth = data_set::read_ground_truth(options.scene, options.object);
    const std::map<int, data_set::PoseRow> rows = rows_of_object(options);
    std::vector<FrameErrors> frames;
    for (const auto& [frame_id, camera_from_object] : truth) {
        if (frame_id < options.first.value_or(frame_id) || frame_id > options.last.value_or(frame_id)) continue;
        const auto row = rows.find(frame_id);
        frames.emplace_back().frame_id = frame_id;
        if (row != rows.end()) {
            frames.back().errors = evaluation::pose_error(row->second.camera_from_object, camera_from_object, model);
        }
    }
    if (frames.empty()) throw std::runtime_error(options.scene.string() + ": no frame between --first and --last");
    return frames;
}

std::string short_table(const std::vector<FrameErrors>& frames) {
    std::string table = "im_id,translation_error_mm,rotation_error_deg\n";
    for (const FrameErrors& frame : frames) {
        table += std::to_string(frame.frame_id) + ",";
        if (frame.errors) table += data_set::format_fixed(1e3 * frame.errors->translation_m, 4);
        table += ",";
        if (frame.errors) table += data_set::format_fixed(kDegrees * frame.errors->rotation_rad, 4);
        table += "\n";
    }
    return table;
}

std::string padded(const std::string& text, std::size_t width) {
    return text.size() < width ? std::string(width - text.size(), ' ') + text : text;
}

std::string statistics_row(const std::string& label, const std::vector<double>& values) {
    const evaluation::Statistics statistics = evaluation::statistics_of(values);
    std::string row = label + std::string(18 - label.size(), ' ');
    for (const double value : {statistics.mean, statistics.median, statistics.percentile_95, statistics.max}) {
        row += padded(data_set::format_fixed(value, 3), 10);
    }
    return row + "\n";
}

std::string arrival_text(const EvaluateOptions& options, const std::vector<FrameErrors>& frames) {
    const evaluation::ErrorLimit limit{1e-3 * options.within_mm, options.within_deg / kDegrees};
    const std::string name = "within " + data_set::format_number(options.within_mm) + " mm and " +
                             data_set::format_number(options.within_deg) + " deg: ";
    const evaluation::Arrival arrival = evaluation::arrival_of(frames, limit);
    const auto frame_of = [&](int index) { return std::to_string(frames[static_cast<std::size_t>(index)].frame_id); };
    if (!arrival.first_index) return name + "never\n";
    std::string text = name + "first in frame " + frame_of(*arrival.first_index);
    if (!arrival.holds_from) return text + ", but not in the last frame\n";
    return text + (arrival.stays() ? ", and in every frame from there on\n"
                                   : ", for good from frame " + frame_of(*arrival.holds_from) + " on\n");
}

std::string summary_of(const EvaluateOptions& options, const std::vector<FrameErrors>& frames) {
    std::vector<double> translations_mm, rotations_deg;
    std::size_t missing = 0;
    const std::size_t burn_in = std::min(frames.size(), static_cast<std::size_t>(options.burn_in));
    for (std::size_t i = 0; i < frames.size(); ++i) {
        if (!frames[i].errors) ++missing;
        if (i < burn_in || !frames[i].errors) continue;
        translations_mm.push_back(1e3 * frames[i].errors->translation_m);
        rotations_deg.push_back(kDegrees * frames[i].errors->rotation_rad);
    }
    std::string text = "object " + std::to_string(options.object) + " in " + options.scene.string() + ": " +
                       std::to_string(frames.size()) + " frames, " + std::to_string(missing) + " without a pose\n";
    if (burn_in < frames.size()) {
        text += "frames " + std::to_string(frames[burn_in].frame_id) + " to " + std::to_string(frames.back().frame_id) +
                (burn_in > 0 ? " (those before are the burn-in)" : "") + "\n";
    }
    if (translations_mm.empty()) {
        text += "no frame with a pose after the burn-in\n";
    } else {
        text += std::string(18, ' ') + padded("mean", 10) + padded("median", 10) + padded("95 %", 10) +
                padded("max", 10) + "\n";
        text += statistics_row("translation [mm]", translations_mm);
        text += statistics_row("rotation [deg]", rotations_deg);
    }
    return text + arrival_text(options, frames);
}

int evaluate(const EvaluateOptions& options, const SharedOptions&) {
    const std::vector<FrameErrors> frames = errors_of(options);
    if (!options.out.empty() && options.out != "-") {
        data_set::write_file_atomically(options.out, short_table(frames));
    }
    if (!options.plot.empty()) {
        std::vector<pictures::ErrorPoint> points;
        for (const FrameErrors& frame : frames) {
            pictures::ErrorPoint point;
            point.frame_id = frame.frame_id;
            if (frame.errors) point.translation_mm = 1e3 * frame.errors->translation_m;
            if (frame.errors) point.rotation_deg = kDegrees * frame.errors->rotation_rad;
            points.push_back(point);
        }
        pictures::write_error_plot(options.plot, "Pose error, object " + std::to_string(options.object), points);
    }
    print(options.out == "-" ? short_table(frames) : summary_of(options, frames));
    return kSuccess;
}

}  // namespace

void add_evaluate_command(CLI::App& app, const SharedOptions& shared, Run& run) {
    auto options = std::make_shared<EvaluateOptions>();
    CLI::App* command = app.add_subcommand("evaluate", "Errors of a result file against the scene's true poses");
    command->footer(
        "The translation error is that of the centre of the model's box. Of the poses in which a symmetric part looks\n"
        "the same, the one counts in which the corners of its box are nearest to the estimate's.");
    command->add_option("--scene", options->scene, "Folder of a BOP scene with scene_gt.json")->required();
    command->add_option("--models", options->models, "Folder of BOP models with models_info.json")->required();
    command->add_option("--object", options->object, "Number of the object");
    command->add_option("--results", options->results, "BOP result file")->required();
    command->add_option("--scene-id", options->scene_id, "scene_id of the results [the folder's number]");
    command->add_option("--first", options->first, "Number of the first frame [the scene's first]");
    command->add_option("--last", options->last, "Number of the last frame [the scene's last]");
    command->add_option("--burn-in", options->burn_in, "Frames at the beginning that the statistics leave out")
        ->check(CLI::NonNegativeNumber);
    command->add_option("--within-mm", options->within_mm, "Limit of arrival [mm]")->check(CLI::PositiveNumber);
    command->add_option("--within-deg", options->within_deg, "Limit of arrival [deg]")->check(CLI::PositiveNumber);
    command->add_option("--out", options->out, "Table of errors to write, a row a frame; - instead of the summary");
    command->add_option("--plot", options->plot, "Picture of errors over frames to write (PNG)");
    command->callback([options, &shared, &run] { run = [options, &shared] { return evaluate(*options, shared); }; });
}

}  // namespace nearpose::program
