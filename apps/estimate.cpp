#include "apps/estimate.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <numbers>

#include "apps/console.hpp"
#include "apps/data_set/number_text.hpp"
#include "apps/data_set/result_csv.hpp"
#include "apps/estimate_outputs.hpp"
#include "apps/estimator_setup.hpp"
#include "apps/frame_source.hpp"
#include "apps/model_input.hpp"
#include "apps/pose_file.hpp"
#include "core/estimator.hpp"

namespace nearpose::program {
namespace {

struct EstimateOptions {
    std::filesystem::path scene, clouds, camera;
    ModelOptions model;
    OutputOptions outputs;
    std::string views = "raycast", method = "default";
    int particles = EstimatorOptions{}.num_particles;
    int threads = EstimatorOptions{}.num_threads;
    std::uint64_t seed = EstimatorOptions{}.seed;
    bool no_mask = false, no_control = false;
    std::optional<int> mask_index, first, last, scene_id;
    double fps = 30.0;
    std::filesystem::path initial_pose;
    double initial_sigma_mm = 10.0, initial_sigma_deg = 5.0;
};

struct Tally {
    int frames = 0, unread = 0, seen = 0;
};

void add_input_options(CLI::App& command, EstimateOptions& options) {
    command.add_option("--scene", options.scene, "Folder of a BOP scene: scene_camera.json, depth/, mask_visib/");
    command.add_option("--clouds", options.clouds,
                       "Instead of --scene: folder of .pcd or .ply clouds, camera frame, m");
    command.add_option("--camera", options.camera, "camera.json of --clouds (cx cy fx fy width height)");
    add_bop_model_options(command, options.model);
    add_model_file_options(command, options.model);
    command.add_flag("--no-mask", options.no_mask, "Use every measured point in range, not the mask's alone");
    command.add_option("--mask-index", options.mask_index, "KKKKKK of the mask files [from scene_gt.json, else 0]")
        ->check(CLI::Range(0, 999999));
    command.add_flag("--no-control", options.no_control, "Leave the measured camera motion unused");
    command.add_option("--first", options.first, "Number of the first frame [the scene's first]");
    command.add_option("--last", options.last, "Number of the last frame [the scene's last]");
    command.add_option("--scene-id", options.scene_id, "scene_id of the results [the folder's number]");
    command.add_option("--fps", options.fps, "Frames per second where the scene has no time stamps")
        ->check(CLI::Range(1e-3, 1e6));
}

void add_estimator_options(CLI::App& command, EstimateOptions& options) {
    command.add_option("--views", options.views, "View generation: raycast, raster or sphere")
        ->check(CLI::IsMember(view_names()));
    command.add_option("--method", options.method, "default, or paper: the paper's formulas to the letter")
        ->check(CLI::IsMember(method_names()));
    command.add_option("--particles", options.particles, "Number of particles")->check(CLI::Range(1, 1000000));
    command.add_option("--threads", options.threads, "Threads; 0: all. Results do not depend on it")
        ->check(CLI::Range(0, 4096));
    command.add_option("--seed", options.seed, "Seed of all random draws");
    command.add_option("--initial-pose", options.initial_pose, "Start from this pose: JSON with cam_R_m2c, cam_t_m2c");
    command.add_option("--initial-sigma-mm", options.initial_sigma_mm, "Spread of the start around that pose [mm]")
        ->check(CLI::Range(0.0, 1e6));
    command.add_option("--initial-sigma-deg", options.initial_sigma_deg, "Spread of the start around that pose [deg]")
        ->check(CLI::Range(0.0, 180.0));
}

void add_output_options(CLI::App& command, OutputOptions& options) {
    command
        .add_option("--out", options.out,
                    "BOP result file to write (bop_toolkit wants METHOD_DATASET-SPLIT.csv); - is the standard output")
        ->required();
    command.add_option("--log", options.log, "Log to write: a JSON object a line");
    command.add_option("--trajectory", options.trajectory, "Trajectory to write: TUM rows, metres");
    command
        .add_option("--trajectory-frame", options.trajectory_frame,
                    "Its rows: camera (camera_from_object), object (inverse), world (world_from_object)")
        ->check(CLI::IsMember({"camera", "object", "world"}));
    command.add_option("--pictures", options.pictures, "Folder to write a picture of each frame into");
}

void check(const EstimateOptions& options) {
    if (options.scene.empty() == options.clouds.empty()) {
        throw BadUse(options.scene.empty() ? "an input is needed: --scene DIR, or --clouds DIR --camera camera.json"
                                           : "--scene and --clouds exclude each other");
    }
    if (options.clouds.empty() != options.camera.empty()) throw BadUse("--clouds and --camera go together");
    if (options.mask_index && options.no_mask) throw BadUse("--mask-index and --no-mask exclude each other");
    if (options.first && options.last && *options.first > *options.last) throw BadUse("--first lies after --last");
    if (options.outputs.trajectory_frame == "world" && !options.clouds.empty()) {
        throw BadUse("--trajectory-frame world needs the camera motion of a --scene");
    }
    check(options.model);
    check(options.outputs);
}

std::unique_ptr<FrameSource> open_source(const EstimateOptions& options) {
    const data_set::SceneOptions scene{options.scene_id, options.fps, options.first, options.last};
    if (options.scene.empty()) return open_cloud_source(options.clouds, options.camera, scene, !options.no_mask);
    return open_bop_source(options.scene, scene, {!options.no_mask, options.model.object, options.mask_index});
}

PoseEstimator make_estimator(const EstimateOptions& options, const Mesh& mesh) {
    EstimatorOptions estimator;
    estimator.method = make_method(options.method);
    estimator.num_particles = options.particles;
    estimator.num_threads = options.threads;
    estimator.seed = options.seed;
    PoseEstimator made(make_view_generator(options.views, mesh), make_solver(options.method), estimator);
    if (!options.initial_pose.empty()) {
        made.reset(read_pose_file(options.initial_pose),
                   {options.initial_sigma_deg * std::numbers::pi / 180.0, 1e-3 * options.initial_sigma_mm});
    }
    return made;
}

RunDescription describe(const EstimateOptions& options, const FrameSource& source) {
    return {(options.scene.empty() ? options.clouds : options.scene).string(),
            model_file(options.model).string(),
            options.views,
            options.method,
            source.scene_id(),
            options.model.object,
            options.particles,
            options.seed};
}

// What the frames lack for what was asked, before hours are spent.
void check_motion(const EstimateOptions& options, const FrameSource& source) {
    if (options.outputs.trajectory.empty() || options.outputs.trajectory_frame != "world") return;
    for (const FrameInfo& frame : source.frames()) {
        if (frame.camera_from_world) return;
    }
    throw std::runtime_error(options.scene.string() +
                             ": --trajectory-frame world needs cam_R_w2c and cam_t_w2c in scene_camera.json");
}

std::optional<Pose> control_of(const FrameSource& source, std::size_t index) {
    if (index == 0) return std::nullopt;
    const std::optional<Pose>& now = source.frames()[index].camera_from_world;
    const std::optional<Pose>& before = source.frames()[index - 1].camera_from_world;
    if (!now || !before) return std::nullopt;
    return *now * before->inverse();
}

// What a frame that could be read had to offer.
std::string why_unseen(const FrameData& data, const Observation& observation) {
    if (observation.num_candidates() > 0) return std::to_string(observation.num_candidates()) + " measured points";
    std::vector<float> depths_m;
    for (std::size_t i = 0; i < data.depth.depth_m.size(); ++i) {
        const bool wanted = !data.mask || data.mask->value[i] != 0;
        if (wanted && data.depth.depth_m[i] > 0.0F) depths_m.push_back(data.depth.depth_m[i]);
    }
    for (const Eigen::Vector3f& point : data.points_in_camera) depths_m.push_back(point.z());
    if (depths_m.empty()) return "nothing is measured in its mask";
    const auto middle = depths_m.begin() + static_cast<std::ptrdiff_t>(depths_m.size() / 2);
    std::nth_element(depths_m.begin(), middle, depths_m.end());
    const SensorModel& sensor = observation.sensor();
    return "no measurement lies in the image and at " + data_set::format_number(sensor.min_range_m) + " to " +
           data_set::format_number(sensor.max_range_m) + " m; half are nearer than " +
           data_set::format_fixed(*middle, 4) + " m: is the depth's scale right?";
}

void run_frame(const EstimateOptions& options, const SharedOptions& shared, const FrameSource& source,
               std::size_t index, PoseEstimator& estimator, EstimateOutputs& outputs, Tally& tally) {
    const FrameInfo& frame = source.frames()[index];
    const std::string name = "frame " + std::to_string(frame.id);
    FrameReport report{frame.id, frame.stamp_s, 0.0, {}};
    FrameData data;
    try {
        data = source.load(index);
    } catch (const std::exception& error) {
        // An empty observation stands in, so that the control still moves the pose.
        report.error = error.what();
    }
    const auto begin = std::chrono::steady_clock::now();
    const Observation observation = observe_frame(frame, data);
    const UpdateResult result =
        estimator.update(observation, options.no_control ? std::nullopt : control_of(source, index));
    report.time_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();

    const bool predicted = result.status == UpdateStatus::kPredicted;
    const std::string consequence = predicted ? "; the prediction stands in" : "; there is no pose yet";
    ++tally.frames;
    if (!report.error.empty()) {
        ++tally.unread;
        print_error(name + ": " + report.error + consequence);
    } else if (result.status != UpdateStatus::kEstimated) {
        print_notice(name + ": the object is not seen (" + why_unseen(data, observation) + ")" + consequence,
                     shared.quiet);
    }
    if (result.status == UpdateStatus::kEstimated) ++tally.seen;
    outputs.append(frame, report, observation, result);
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

int estimate(const EstimateOptions& options, const SharedOptions& shared) {
    check(options);
    const std::unique_ptr<FrameSource> source = open_source(options);
    check_motion(options, *source);
    const Mesh mesh = load_model(options.model, shared);
    PoseEstimator estimator = make_estimator(options, mesh);
    EstimateOutputs outputs(options.outputs, describe(options, *source), mesh);
    if (!source->notice().empty()) print_notice(source->notice(), shared.quiet);
    if (const auto notice = data_set::bop_file_name_notice(options.outputs.out)) print_notice(*notice, shared.quiet);

    Tally tally;
    Progress progress("estimate", static_cast<int>(source->frames().size()), shared.quiet);
    for (std::size_t index = 0; index < source->frames().size() && !interrupted(); ++index) {
        run_frame(options, shared, *source, index, estimator, outputs, tally);
        progress.step();
    }
    outputs.close();
    return exit_code(tally);
}

}  // namespace

void add_estimate_command(CLI::App& app, const SharedOptions& shared, Run& run) {
    auto options = std::make_shared<EstimateOptions>();
    CLI::App* command = app.add_subcommand("estimate", "Pose of a part in every frame of a scene");
    add_input_options(*command, *options);
    add_estimator_options(*command, *options);
    add_output_options(*command, options->outputs);
    command->callback([options, &shared, &run] { run = [options, &shared] { return estimate(*options, shared); }; });
}

}  // namespace nearpose::program
