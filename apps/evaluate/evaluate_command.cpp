#include "apps/evaluate/evaluate_command.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <memory>

#include "apps/base/console.hpp"
#include "apps/base/degrees.hpp"
#include "apps/base/file_io.hpp"
#include "apps/data_set/trajectory_tum.hpp"
#include "apps/evaluate/error_curves.hpp"
#include "apps/evaluate/estimates.hpp"
#include "apps/evaluate/summary_text.hpp"
#include "apps/pictures/error_plot.hpp"

namespace nearpose::program {
namespace {

using evaluation::FrameErrors;

struct EvaluateOptions {
    std::filesystem::path scene, models, results, log;
    std::filesystem::path out, json, plot, curves, calibration, trajectories;
    int object = 1;
    std::optional<int> scene_id, mask_index, first, last;
    int burn_in = evaluation::SummaryOptions{}.burn_in;
    double within_mm = 10.0, within_deg = 5.0;
    std::optional<double> tolerance_mm, tolerance_deg;  // of the verdicts; none: the log's, else the estimation's usual
};

void check(const EvaluateOptions& options) {
    if (!options.calibration.empty() && options.log.empty()) {
        throw BadUse("--calibration needs the covariances: give the log of the estimation with --log");
    }
    if ((options.tolerance_mm || options.tolerance_deg) && options.log.empty()) {
        throw BadUse(
            "--tolerance-mm and --tolerance-deg judge verdicts: give the log of the estimation, which has them, "
            "with --log");
    }
    const std::array<const std::filesystem::path*, 5> files = {&options.out, &options.json, &options.plot,
                                                               &options.curves, &options.calibration};
    for (std::size_t i = 0; i < files.size(); ++i) {
        for (std::size_t j = i + 1; j < files.size(); ++j) {
            if (!files[i]->empty() && *files[i] == *files[j] && *files[i] != "/dev/null") {
                throw BadUse("two of --out, --json, --plot, --curves and --calibration are " + files[i]->string());
            }
        }
    }
}

void write_text(const std::filesystem::path& path, const std::string& text) {
    if (!path.empty() && path != "-") data_set::write_file_atomically(data_set::with_folder(path), text);
}

void write_error_plot(const EvaluateOptions& options, const std::vector<FrameErrors>& frames) {
    std::vector<pictures::ErrorPoint> points;
    for (const FrameErrors& frame : frames) {
        pictures::ErrorPoint& point = points.emplace_back();
        point.frame_id = frame.frame_id;
        if (frame.errors) point.translation_mm = 1e3 * frame.errors->translation_m;
        if (frame.errors) point.rotation_deg = kDegrees * frame.errors->rotation_rad;
    }
    pictures::write_error_plot(data_set::with_folder(options.plot),
                               "Pose error, object " + std::to_string(options.object), points);
}

// The curves are of the frames after the burn-in, as the statistics are.
void write_curves(const EvaluateOptions& options, const evaluation::SceneTruth& truth,
                  const std::vector<FrameErrors>& frames) {
    const auto burn_in = std::min<std::ptrdiff_t>(options.burn_in, static_cast<std::ptrdiff_t>(frames.size()));
    const std::vector<FrameErrors> settled(frames.begin() + burn_in, frames.end());
    if (!options.curves.empty()) {
        const auto plots = evaluation::error_curves(settled);
        if (plots.empty()) {
            throw std::runtime_error(
                "--curves: no frame after the burn-in has both a pose and visible points" +
                (truth.visibility_problem.empty() ? std::string() : " (" + truth.visibility_problem + ")"));
        }
        pictures::write_curve_plots(data_set::with_folder(options.curves), plots);
    }
    if (!options.calibration.empty()) {
        const auto plots = evaluation::calibration_curves(settled);
        if (plots.empty()) {
            throw std::runtime_error(options.log.string() + ": has no covariance of a frame after the burn-in");
        }
        pictures::write_curve_plots(data_set::with_folder(options.calibration), plots);
    }
}

// For evo: both with the same stamps, of the centre of the box, whose error is that of the summary; the truth is the
// equivalent pose that is nearest.
void write_trajectories(const std::filesystem::path& folder, const evaluation::SceneTruth& truth,
                        const evaluation::Estimates& estimates, const evaluation::ModelShape& shape) {
    data_set::create_folder(folder);
    data_set::TumWriter true_poses(folder / "truth.tum"), poses(folder / "poses.tum");
    const Pose object_from_centre{Eigen::Quaterniond::Identity(), shape.centre_in_object_m()};
    for (std::size_t i = 0; i < truth.frames.size(); ++i) {
        const auto found = estimates.of_frame.find(truth.frames[i].frame_id);
        if (found == estimates.of_frame.end()) continue;
        const Pose& estimate = found->second.camera_from_object;
        const Pose nearest = evaluation::nearest_equivalent(estimate, truth.frames[i].camera_from_object, shape.info);
        true_poses.append(truth.images[i].stamp_s, nearest * object_from_centre);
        poses.append(truth.images[i].stamp_s, estimate * object_from_centre);
    }
    true_poses.close();
    poses.close();
}

// What is asked for, else what the log states, else what `nearpose estimate` takes by itself.
Tolerance tolerance_of(const EvaluateOptions& options, const evaluation::Estimates& estimates, bool quiet) {
    const bool one_missing = !options.tolerance_mm || !options.tolerance_deg;
    if (one_missing && !estimates.tolerance && !estimates.verdicts.empty()) {
        print_notice(options.log.string() +
                         ": does not state the verdicts' tolerance; where --tolerance-mm or --tolerance-deg is not "
                         "given, 2 mm and 1 deg are taken",
                     quiet);
    }
    Tolerance tolerance = estimates.tolerance.value_or(Tolerance{});
    if (options.tolerance_mm) tolerance.translation_m = 1e-3 * *options.tolerance_mm;
    if (options.tolerance_deg) tolerance.rotation_rad = *options.tolerance_deg / kDegrees;
    return tolerance;
}

int evaluate(const EvaluateOptions& options, const SharedOptions& shared) {
    check(options);
    data_set::SceneOptions which;
    which.scene_id = options.scene_id;
    which.first_frame = options.first;
    which.last_frame = options.last;
    evaluation::SceneTruth truth = evaluation::read_truth(options.scene, options.object, which, options.mask_index);
    evaluation::Estimates estimates = evaluation::read_estimates(options.results, truth);
    if (!options.log.empty()) evaluation::add_log(options.log, estimates);
    const evaluation::ModelShape shape = evaluation::load_shape(options.models, options.object);
    evaluation::add_visibility(truth);
    for (const std::string& notice : estimates.notices) print_notice(notice, shared.quiet);
    if (!truth.visibility_problem.empty()) {
        print_notice("distance and visible volume are left out of some frames: " + truth.visibility_problem,
                     shared.quiet);
    }

    const std::vector<FrameErrors> frames = evaluation::errors_of(truth, estimates, shape);
    evaluation::SummaryOptions limits;
    limits.burn_in = options.burn_in;
    limits.coarse = {1e-3 * options.within_mm, options.within_deg / kDegrees};
    limits.tolerance = tolerance_of(options, estimates, shared.quiet);
    const evaluation::RunSummary summary = evaluation::summarise(frames, shape.info.diameter_m, limits);
    const evaluation::SummaryHeading heading{options.scene.string(), options.results.string(), truth.scene.id,
                                             options.object, shape.info.diameter_m};
    // Which verdicts are wrong is a column of the table where there are verdicts.
    const std::optional<Tolerance> judged =
        summary.verdicts.frames > 0 ? std::optional(limits.tolerance) : std::nullopt;
    const std::string table = evaluation::table_of(frames, judged);
    const std::string json = evaluation::summary_json(heading, frames, summary, limits);
    write_text(options.out, table);
    write_text(options.json, json);
    if (!options.plot.empty()) write_error_plot(options, frames);
    write_curves(options, truth, frames);
    if (!options.trajectories.empty()) write_trajectories(options.trajectories, truth, estimates, shape);
    if (options.out == "-") {
        print(table);
    } else if (options.json == "-") {
        print(json);
    } else {
        print(evaluation::summary_text(heading, frames, summary, limits));
    }
    return kSuccess;
}

}  // namespace

void add_evaluate_command(CLI::App& app, const SharedOptions& shared, Run& run) {
    auto options = std::make_shared<EvaluateOptions>();
    CLI::App* command = app.add_subcommand("evaluate", "Errors of a result file against the scene's true poses");
    command->footer(
        "The translation error is that of the centre of the model's box. Of the poses in which a symmetric part looks\n"
        "the same, the one counts in which the corners of its box are nearest to the estimate's. ADD, ADD-S (ADI),\n"
        "MSSD and MSPD are bop_toolkit's, over the vertices of models_eval beside --models where there is that "
        "folder.");
    command->add_option("--scene", options->scene, "Folder of a BOP scene with scene_gt.json")->required();
    command->add_option("--models", options->models, "Folder of BOP models with models_info.json")->required();
    command->add_option("--object", options->object, "Number of the object");
    command->add_option("--results", options->results, "BOP result file")->required();
    command->add_option("--log", options->log,
                        "Log of the same estimation, for covariances, verdicts and predicted frames");
    command
        ->add_option("--mask-index", options->mask_index, "Of several copies, that at this index of the frame's list")
        ->check(CLI::Range(0, 999'999));
    command->add_option("--scene-id", options->scene_id, "scene_id of the results [the folder's number]");
    command->add_option("--first", options->first, "Number of the first frame [the scene's first]");
    command->add_option("--last", options->last, "Number of the last frame [the scene's last]");
    command->add_option("--burn-in", options->burn_in, "Frames at the beginning that the statistics leave out")
        ->check(CLI::NonNegativeNumber);
    command->add_option("--within-mm", options->within_mm, "Limit of arrival [mm]")->check(CLI::PositiveNumber);
    command->add_option("--within-deg", options->within_deg, "Limit of arrival [deg]")->check(CLI::PositiveNumber);
    command
        ->add_option("--tolerance-mm", options->tolerance_mm,
                     "An accepted pose is a false accept beyond this [mm] [what the log states, else 2]")
        ->check(CLI::PositiveNumber);
    command->add_option("--tolerance-deg", options->tolerance_deg, "Or beyond this [deg] [what the log states, else 1]")
        ->check(CLI::PositiveNumber);
    command->add_option("--out", options->out, "Table of errors to write, a row a frame; - instead of the summary");
    command->add_option("--json", options->json, "All figures as JSON to write; - instead of the summary");
    command->add_option("--plot", options->plot, "Picture of errors over frames to write (PNG)");
    command->add_option("--curves", options->curves,
                        "Picture of errors over distance, visible volume and visible fraction to write (PNG)");
    command->add_option(
        "--calibration", options->calibration,
        "Picture of how often the truth lies inside the covariance's p-region, against p and against distance, "
        "to write (PNG)");
    command->add_option("--trajectory-out", options->trajectories,
                        "Folder for truth.tum and poses.tum with equal stamps, of the centre of the box, for evo");
    command->callback([options, &shared, &run] { run = [options, &shared] { return evaluate(*options, shared); }; });
}

}  // namespace nearpose::program
