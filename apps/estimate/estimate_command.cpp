#include "apps/estimate/estimate_command.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <utility>

#include "apps/base/console.hpp"
#include "apps/base/number_text.hpp"
#include "apps/data_set/result_csv.hpp"
#include "apps/estimate/estimate_options.hpp"
#include "apps/estimate/estimate_outputs.hpp"
#include "apps/estimate/unit_check.hpp"
#include "apps/estimate/verdict_summary.hpp"
#include "apps/runs/camera_motion.hpp"
#include "apps/runs/estimator_setup.hpp"
#include "apps/runs/estimator_start.hpp"
#include "apps/runs/input_doubts.hpp"
#include "apps/runs/run_folder.hpp"
#include "apps/set_up/calibration.hpp"
#include "apps/set_up/corrected_source.hpp"
#include "apps/set_up/setup_file.hpp"
#include "core/estimator.hpp"

namespace nearpose::program {
namespace {

struct Tally {
    explicit Tally(UnitCheck check) : unit(std::move(check)) {}

    int frames = 0, unread = 0, seen = 0;
    std::vector<JudgedFrame> judged;
    ArmSentences arm;
    data_set::Notices errors, notices;  // what has been said of frames: each matter once
    UnitCheck unit;
};

JudgedFrame judged(int frame_id, const UpdateResult& result) {
    JudgedFrame frame{frame_id, result.verdict, {}};
    for (const Shortfall& shortfall : result.missing) frame.missing.emplace_back(to_string(shortfall.requirement));
    return frame;
}

bool is_repeated(const UpdateResult& result) {
    return !result.missing.empty() && result.missing.front().requirement == Requirement::kNewImage;
}

RunDescription run_description(const EstimateOptions& options, const FrameSource& source) {
    return {(options.scene.empty() ? options.clouds : options.scene).string(),
            model_file(options.model).string(),
            options.views,
            options.method,
            source.scene_id(),
            options.model.object,
            options.particles.value_or(EstimatorSetup{}.particles),
            !options.particles,
            options.seed,
            tolerance_of(options),
            1e-3 * options.budget_ms};
}

// What every frame of a run is estimated with.
struct RunContext {
    const EstimateOptions& options;
    const SharedOptions& shared;
    const FrameSource& source;
    const Mesh& mesh;
};

// What the frames lack for what was asked, before hours are spent.
void check_motion(const EstimateOptions& options, const FrameSource& source) {
    if (options.outputs.trajectory.empty() || options.outputs.trajectory_frame != "world") return;
    for (const FrameInfo& frame : source.frames()) {
        if (frame.camera_from_world) return;
    }
    throw std::runtime_error(options.scene.string() +
                             ": --trajectory-frame world needs cam_R_w2c and cam_t_w2c in scene_camera.json");
}

// What a frame that could be read had to offer. The observation has taken its image over, so it is read again.
std::string why_unseen(const FrameSource& source, std::size_t index, const Observation& observation) {
    if (observation.num_candidates() > 0) return std::to_string(observation.num_candidates()) + " measured points";
    const FrameData data = source.load(index);
    std::vector<float> depths_m;
    for (std::size_t i = 0; i < data.depth.depth_m.size(); ++i) {
        const bool wanted = !data.mask || data.mask->value[i] != 0;
        if (wanted && data.depth.depth_m[i] > 0.0F) depths_m.push_back(data.depth.depth_m[i]);
    }
    for (const Eigen::Vector3f& point : data.points_in_camera) depths_m.push_back(point.z());
    if (depths_m.empty()) return data.mask ? "nothing is measured in its mask" : "no pixel has a depth";
    const auto middle = depths_m.begin() + static_cast<std::ptrdiff_t>(depths_m.size() / 2);
    std::nth_element(depths_m.begin(), middle, depths_m.end());
    const SensorModel& sensor = observation.sensor();
    return "no measurement lies in the image and at " + data_set::format_number(sensor.min_range_m) + " to " +
           data_set::format_number(sensor.max_range_m) + " m; half are nearer than " +
           data_set::format_fixed(*middle, 4) + " m: is the depth's scale right?";
}

// A frame that cannot be read stays empty: the control still moves the pose.
FrameData read_frame(const FrameSource& source, std::size_t index, FrameReport& report) {
    try {
        return source.load(index);
    } catch (const std::exception& error) {
        report.error = error.what();
        return {};
    }
}

// Says what is to be said of the frame, where it has not been said of another.
void note(int frame_id, const std::string& text, const std::string& consequence, const SharedOptions& shared,
          Tally& tally) {
    if (!tally.notices.add(frame_id, text)) return;
    print_notice("frame " + std::to_string(frame_id) + ": " + text + consequence, shared.quiet);
}

// Before the first frame that could be read: whether its depth can be of the part.
void note_scale(const FrameInfo& frame, const FrameData& data, const Mesh& mesh, const SharedOptions& shared,
                Tally& tally) {
    if (tally.frames > tally.unread || data.depth.depth_m.empty()) return;
    const std::string doubt = scale_doubt(data.depth, data.mask ? &*data.mask : nullptr, frame.camera, extent_of(mesh));
    for (const std::string& text : {doubt, decimation_doubt(data.depth)})
        if (!text.empty()) note(frame.id, text, "", shared, tally);
}

void run_frame(const RunContext& run, std::size_t index, PoseEstimator& estimator, EstimateOutputs& outputs,
               Tally& tally) {
    const FrameInfo& frame = run.source.frames()[index];
    FrameReport report{frame.id, frame.stamp_s, 0.0, {}, {}};
    FrameData data = read_frame(run.source, index, report);
    for (const std::string& text : data.notices) note(frame.id, text, "", run.shared, tally);
    note_scale(frame, data, run.mesh, run.shared, tally);
    const auto begin = std::chrono::steady_clock::now();
    const Observation observation = observe_frame(frame, std::move(data));
    const UpdateResult result =
        estimator.update(observation, run.options.no_control ? std::nullopt : control_of(run.source.frames(), index));
    report.time_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    report.in_world = place_of(run.source.frames(), index, result);

    const bool predicted = result.status == UpdateStatus::kPredicted;
    const std::string consequence = predicted ? "; the prediction stands in" : "; there is no pose yet";
    ++tally.frames;
    if (!report.error.empty()) {
        ++tally.unread;
        if (tally.errors.add(frame.id, report.error)) {
            print_error("frame " + std::to_string(frame.id) + ": " + report.error + consequence);
        }
    } else if (is_repeated(result)) {
        note(frame.id, "the image is the one before", consequence, run.shared, tally);
    } else if (result.status != UpdateStatus::kEstimated) {
        note(frame.id, "the object is not seen (" + why_unseen(run.source, index, observation) + ")", consequence,
             run.shared, tally);
    }
    if (result.status == UpdateStatus::kEstimated) ++tally.seen;
    tally.judged.push_back(judged(frame.id, result));
    gather(tally.arm, frame.id, result.missing);
    const bool is_last = index + 1 == run.source.frames().size();
    if (const auto notice = tally.unit.after(observation, result.verdict, is_last))
        print_notice(*notice, run.shared.quiet);
    outputs.append(frame, report, observation, result, estimator.particles());
}

// Once, at the end: in how many frames what was said of one is so, and what is odd about the stamps.
void print_repeats(const Tally& tally, const FrameSource& source, const SharedOptions& shared) {
    for (const data_set::Notice& error : tally.errors.all()) {
        if (error.times > 1) print_error(repeats_of(error));
    }
    for (const data_set::Notice& notice : tally.notices.all()) {
        if (notice.times > 1) print_notice(repeats_of(notice), shared.quiet);
    }
    for (const data_set::Notice& notice : source.time_notices().all()) print_notice(to_text(notice), shared.quiet);
}

// Nothing where the part was never seen: exit_code says that, and what to check.
void print_verdicts(const Tally& tally, const SharedOptions& shared) {
    if (tally.seen == 0) return;
    for (const std::string& line : summary_lines(tally_of(tally.judged))) print_notice(line, shared.quiet);
    for (const auto& [requirement, sentence] : tally.arm) print_notice(sentence, shared.quiet);
}

int exit_code(const Tally& tally) {
    if (interrupted()) {
        print_error("interrupted after " + std::to_string(tally.frames) + " frames");
        return kInterrupted;
    }
    if (tally.unread == tally.frames) {
        print_error("none of the " + std::to_string(tally.frames) + " frames could be read");
        return kFailure;
    }
    if (tally.seen == 0) {
        print_error("the object was seen in none of the " + std::to_string(tally.frames) +
                    " frames; check the model's unit, the depth's scale and the start");
        return kFailure;
    }
    if (tally.unread == 0) return kSuccess;
    print_error(std::to_string(tally.unread) + " of " + std::to_string(tally.frames) + " frames could not be read");
    return kFramesUnread;
}

// The recording as it was given, or corrected by a file or by itself. The user is told what was found.
std::shared_ptr<const FrameSource> with_right_setup(const std::shared_ptr<const FrameSource>& given,
                                                    const EstimateOptions& options, const Mesh& mesh,
                                                    const EstimatorSetup& setup,
                                                    const std::shared_ptr<const ViewGenerator>& views,
                                                    const SharedOptions& shared) {
    if (!options.set_up.empty()) return corrected_source(given, read_setup_file(options.set_up));
    if (!options.self_calibrate) return given;
    CalibrationOptions calibration;
    Progress progress("calibrate", calibration.passes * static_cast<int>(given->frames().size()), shared.quiet);
    const auto go_on = [&] {
        progress.step();
        return !interrupted();
    };
    const Calibration found = calibrate(given, extent_of(mesh).centre_in_object(), setup, views, go_on, calibration);
    if (!found.solved || found.mistake != MotionMistake::kNone) {
        print_notice("--self-calibrate: the recording does not show its set-up; it is taken as given", shared.quiet);
        return given;
    }
    print_notice(
        "--self-calibrate: " + (found.unknown.empty() ? std::string("nothing seems at fault") : in_one_line(found)),
        shared.quiet);
    return corrected_source(given, found.errors);
}

int estimate(const EstimateOptions& asked, const SharedOptions& shared) {
    check(asked);
    EstimateOptions options = asked;
    options.outputs = with_run_folder(asked.outputs);
    const std::shared_ptr<const FrameSource> given = open_source(options);
    check_motion(options, *given);
    const Mesh mesh = load_model(options.model, shared);
    const EstimatorSetup setup = setup_of(options, mesh, shared);
    const std::shared_ptr<const ViewGenerator> views = make_view_generator(setup, mesh);
    const std::shared_ptr<const FrameSource> source = with_right_setup(given, options, mesh, setup, views, shared);
    PoseEstimator estimator = start_estimator(setup, views, options);
    EstimateOutputs outputs(options.outputs, run_description(options, *source), mesh);
    if (!options.outputs.run.empty()) write_run_record(options.outputs.run, options, source->scene_id());
    for (const data_set::Notice& notice : source->notices().all()) print_notice(to_text(notice), shared.quiet);
    const std::string data_set_name =  // <data set>/test/<scene>
        std::filesystem::absolute(options.scene / "../../.").lexically_normal().parent_path().filename().string();
    if (const auto notice = data_set::bop_file_name_notice(asked.outputs.out, data_set_name);
        notice && !asked.outputs.out.empty()) {
        print_notice(*notice, shared.quiet);
    }

    Tally tally(UnitCheck(options.model, extent_of(mesh).diameter_m()));
    Progress progress("estimate", static_cast<int>(source->frames().size()), shared.quiet);
    for (std::size_t index = 0; index < source->frames().size() && !interrupted(); ++index) {
        run_frame({options, shared, *source, mesh}, index, estimator, outputs, tally);
        progress.step();
    }
    outputs.close();
    print_repeats(tally, *source, shared);
    print_verdicts(tally, shared);
    return exit_code(tally);
}

}  // namespace

void add_estimate_command(CLI::App& app, const SharedOptions& shared, Run& run) {
    auto options = std::make_shared<EstimateOptions>();
    CLI::App* command = app.add_subcommand("estimate", "Pose of a part in every frame of a scene");
    add_estimate_options(*command, *options);
    command->callback([options, &shared, &run] { run = [options, &shared] { return estimate(*options, shared); }; });
}

}  // namespace nearpose::program
