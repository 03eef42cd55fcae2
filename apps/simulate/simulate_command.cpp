#include "apps/simulate/simulate_command.hpp"

#include <CLI/CLI.hpp>
#include <cmath>
#include <memory>
#include <optional>

#include "apps/base/console.hpp"
#include "apps/data_set/camera_json.hpp"
#include "apps/depth_sensor/sensor_file.hpp"
#include "apps/part_model/model_input.hpp"
#include "apps/part_model/model_symmetries.hpp"
#include "apps/scenes/parts.hpp"
#include "apps/simulate/simulate.hpp"

namespace nearpose::program {
namespace {

using simulate::RecordingOptions;
using simulate::Scenario;
using simulate::SimulationOptions;

// As on the command line: millimetres, degrees, milliseconds.
struct SimulateOptions {
    std::filesystem::path out;
    bool force = false;
    int threads = 0;

    std::string scenario = "piston";
    std::string part = "engine_block";
    ModelOptions model;
    bool no_symmetries = false;
    std::uint64_t seed = 1;
    int frames = 0;  // 0: as many as the scenario has by itself
    double fps = 30.0;
    bool no_table = false;

    std::filesystem::path trajectory;
    std::optional<double> conveyor_mm, conveyor_deg, occlusion;

    std::string sensor;
    std::filesystem::path camera;
    double noise_scale = 1.0;
    std::optional<std::string> material;
    bool save_infrared = false;
    double drop_frames = 0.0;

    double arm_mm = 0.1, arm_deg = 0.02;
    double hand_eye_mm = 0.0, hand_eye_deg = 0.0;
    double time_offset_ms = 0.0;

    simulate::MaskErrors mask;
    std::vector<std::string> faults;
};

double radians(double degrees) {
    return degrees * M_PI / 180.0;
}

// TUM's own recordings give four digits of a quaternion.
constexpr double kMaxNormError = 1e-3;

void require_scenario(bool given, const char* option, Scenario needed, Scenario chosen) {
    if (!given || needed == chosen) return;
    throw BadUse(std::string(option) + " belongs to --scenario " + simulate::name_of(needed) + ", not " +
                 simulate::name_of(chosen));
}

simulate::ScenarioOptions scenario_options(const SimulateOptions& command, Scenario scenario) {
    require_scenario(!command.trajectory.empty(), "--trajectory", Scenario::kHandheld, scenario);
    require_scenario(command.conveyor_mm.has_value(), "--conveyor-mm", Scenario::kConveyor, scenario);
    require_scenario(command.conveyor_deg.has_value(), "--conveyor-deg", Scenario::kConveyor, scenario);
    require_scenario(command.occlusion.has_value(), "--occlusion", Scenario::kClutter, scenario);
    simulate::ScenarioOptions options;
    if (!command.trajectory.empty()) options.trajectory = data_set::read_tum(command.trajectory, kMaxNormError);
    if (command.conveyor_mm) options.conveyor_step_m = *command.conveyor_mm * 1e-3;
    if (command.conveyor_deg) options.conveyor_turn_rad = radians(*command.conveyor_deg);
    options.occlusion = command.occlusion;
    return options;
}

// The sensor's own camera, unless another one is named.
void set_sensor(const SimulateOptions& command, RecordingOptions& options) {
    if (!command.sensor.empty()) {
        const simulate::SensorDescription sensor = simulate::read_sensor(command.sensor);
        options.camera = sensor.camera;
        options.depth_scale_mm = sensor.depth_scale_mm;
        options.sensor = sensor.noise;
        options.stereo = sensor.stereo;
    }
    if (!command.camera.empty()) {
        const data_set::CameraFile file = data_set::read_camera_json(command.camera);
        options.camera = file.camera;
        if (file.depth_scale_mm) options.depth_scale_mm = *file.depth_scale_mm;
    }
    options.sensor = simulate::scaled(options.sensor, command.noise_scale);
    options.stereo = simulate::scaled(options.stereo, command.noise_scale);
    if (!options.stereo && (command.material || command.save_infrared))
        throw BadUse(std::string(command.material ? "--material" : "--save-infrared") +
                     " belongs to a --sensor that matches infrared images, such as stereo_d435, with noise");
    options.material = command.material.value_or(options.material);
    options.keep_infrared = command.save_infrared;
}

SimulationOptions simulation_options(const SimulateOptions& command) {
    SimulationOptions options;
    options.data_set = command.out;
    options.replace = command.force;
    options.num_threads = command.threads;
    options.find_symmetries = !command.no_symmetries;
    RecordingOptions& recording = options.recording;
    recording.scenario = simulate::scenario_of(command.scenario);
    recording.path = scenario_options(command, recording.scenario);
    recording.num_frames = command.frames;
    recording.frames_per_second = command.fps;
    recording.seed = command.seed;
    set_sensor(command, recording);
    recording.arm = {command.arm_mm * 1e-3, radians(command.arm_deg), command.hand_eye_mm * 1e-3,
                     radians(command.hand_eye_deg), command.time_offset_ms * 1e-3};
    recording.mask = command.mask;
    recording.dropped_fraction = command.drop_frames;
    recording.with_table = !command.no_table;
    if (command.model.model.empty()) recording.part_name = command.part;
    try {
        for (const std::string& fault : command.faults) recording.faults.push_back(simulate::parse_fault(fault));
        simulate::validate(recording);
    } catch (const std::invalid_argument& error) {
        throw BadUse(error.what());
    }
    return options;
}

simulate::EmbeddedPart part_of(const SimulateOptions& command, bool part_given, const SharedOptions& shared) {
    if (command.model.model.empty()) {
        if (!command.model.unit.empty()) throw BadUse("--unit belongs to --model: a built-in part needs none");
        return simulate::embedded_part(command.part);
    }
    if (part_given) throw BadUse("--part and --model name two parts: leave one out");
    const Mesh mesh = load_model(command.model, shared);
    return {mesh, simulate::box_part(extent_of(mesh))};
}

int simulate_recording(const SimulateOptions& command, bool part_given, const SharedOptions& shared) {
    const SimulationOptions options = simulation_options(command);
    const simulate::EmbeddedPart part = part_of(command, part_given, shared);
    Progress progress("simulate", simulate::num_delivered(options.recording), shared.quiet);
    const simulate::SimulationSummary summary = simulate::write_data_set(part.mesh, part.part, options, [&progress] {
        progress.step();
        return !interrupted();
    });
    if (!summary.complete) return kInterrupted;
    if (summary.frames_without_part > 0) {
        print_notice(std::to_string(summary.frames_without_part) +
                         " frames have no depth on the part: it is out of view or out of the sensor's range",
                     shared.quiet);
    }
    if (options.find_symmetries) {
        print_notice("symmetries of the part (models_info.json has the exact ones): " + describe(summary.symmetries),
                     shared.quiet);
    }
    return kSuccess;
}

void add_task_options(CLI::App& command, SimulateOptions& options) {
    command
        .add_option("--scenario", options.scenario,
                    "baseline: still, whole part in view; piston: down to a bore; crankcase: the same onto the "
                    "underside; sweep: straight down, 60 to 10 cm; conveyor: still camera, moving part; handheld; "
                    "clutter: among things, behind a gripper; bin: several copies")
        ->check(CLI::IsMember(simulate::scenario_names()));
    command.add_option("--seed", options.seed, "Same seed, same files");
    command.add_option("--frames", options.frames, "Number of frames; 0: 30 for baseline and conveyor, 60 for others")
        ->check(CLI::Range(0, 100000));
    command.add_option("--fps", options.fps, "Frames per second")->check(CLI::Range(0.001, 10000.0));
    command
        .add_option("--conveyor-mm", options.conveyor_mm, "conveyor: way of the part in mm a frame; else drawn, 0-10")
        ->check(CLI::Range(0.0, 1000.0));
    command.add_option("--conveyor-deg", options.conveyor_deg, "conveyor: turn in degrees a frame; else drawn, 0-1")
        ->check(CLI::Range(0.0, 28.0));
    command
        .add_option("--trajectory", options.trajectory,
                    "handheld: camera path, TUM rows (world_from_camera, m, s); else a made-up hand")
        ->check(CLI::ExistingFile);
    command
        .add_option("--occlusion", options.occlusion,
                    "clutter: hidden fraction of the silhouette where most is; else drawn, 0.2-0.5")
        ->check(CLI::Range(0.0, simulate::kMaxOcclusion));
    command.add_flag("--no-table", options.no_table, "Leave out the table that the part stands on, and the bin");
    for (const char* name : {"--scenario", "--seed", "--frames", "--fps", "--conveyor-mm", "--conveyor-deg",
                             "--trajectory", "--occlusion", "--no-table"}) {
        command.get_option(name)->group("Task");
    }
}

CLI::Option* add_part_options(CLI::App& command, SimulateOptions& options) {
    CLI::Option* part =
        command.add_option("--part", options.part, "Built-in part")->check(CLI::IsMember(simulate::part_names()));
    add_model_file_options(command, options.model);
    command.get_option("--model")->description("Model file, instead of a built-in part");
    command.add_flag("--no-symmetries", options.no_symmetries,
                     "Look for no symmetries and write none into models_info.json");
    for (const char* name : {"--part", "--model", "--unit", "--no-symmetries"}) command.get_option(name)->group("Part");
    return part;
}

void add_sensor_options(CLI::App& command, SimulateOptions& options) {
    std::string names;
    for (const std::string& name : simulate::sensor_names()) names += (names.empty() ? "" : ", ") + name;
    command.add_option("--sensor", options.sensor,
                       "Sets camera, depth scale and noise: " + names +
                           ", or a JSON file (stereo_... and structured_...: match rendered images); without it a "
                           "close-range stereo camera, 640x480 with fx = fy = 600 pixels, 0.1 mm a count");
    command.add_option("--camera", options.camera, "camera.json, instead of the sensor's own camera and depth scale")
        ->check(CLI::ExistingFile);
    command.add_option("--noise-scale", options.noise_scale, "Times the sensor's faults; 0: exact depth")
        ->check(CLI::Range(0.0, 100.0));
    command
        .add_option("--material", options.material,
                    "What the part is made of, for sensors that match infrared images; else cast_iron")
        ->check(CLI::IsMember(simulate::material_names()));
    command.add_flag("--save-infrared", options.save_infrared,
                     "Also write the images that such a sensor matches, as infrared_left and infrared_right; of "
                     "structured light the right one is the pattern");
    command.add_option("--drop-frames", options.drop_frames, "Fraction of the frames that are lost, never the first")
        ->check(CLI::Range(0.0, 0.95));
    command.add_option("--mask-grow", options.mask.grow_pixels, "Given mask: pixels to dilate, negative: to erode")
        ->check(CLI::Range(-1000, 1000));
    command
        .add_option("--mask-bleed", options.mask.bleed_pixels, "Given mask: pixels to spill onto what touches the part")
        ->check(CLI::Range(0, 1000));
    for (const char* name : {"--sensor", "--camera", "--noise-scale", "--material", "--save-infrared", "--drop-frames",
                             "--mask-grow", "--mask-bleed"}) {
        command.get_option(name)->group("Sensor");
    }
}

void add_arm_options(CLI::App& command, SimulateOptions& options) {
    const auto add = [&](const char* name, double& value, const char* text, double low, double high) {
        command.add_option(name, value, text)->check(CLI::Range(low, high))->group("Arm");
    };
    add("--arm-mm", options.arm_mm, "Noise of the reported camera position in mm, standard deviation an axis", 0, 1000);
    add("--arm-deg", options.arm_deg, "Noise of the reported orientation in degrees, standard deviation an axis", 0,
        45);
    add("--hand-eye-mm", options.hand_eye_mm, "Constant error of the reported position in mm", 0, 1000);
    add("--hand-eye-deg", options.hand_eye_deg, "Constant error of the reported orientation in degrees", 0, 45);
    add("--time-offset-ms", options.time_offset_ms, "The arm's pose is the camera's so many ms after the frame", -10000,
        10000);
}

void add_fault_option(CLI::App& command, SimulateOptions& options) {
    command
        .add_option(
            "--fault", options.faults,
            "A fault of the set-up in frames such as 10-39, 10- (to the end), 20 or all; may be given again. The "
            "truth stays that of what the frames should have shown")
        ->type_name("NAME[:VALUE]@FRAMES")
        ->default_str("")
        ->group("Faults");
    command.footer("Faults, in the order in which they are given:\n" + simulate::described_faults());
}

}  // namespace

void add_simulate_command(CLI::App& app, const SharedOptions& shared, Run& run) {
    auto options = std::make_shared<SimulateOptions>();
    CLI::App* command = app.add_subcommand("simulate", "Simulated depth recording of a part, as a BOP data set");
    command->add_option("--out", options->out, "Folder of the BOP data set to write")->required();
    command->add_flag("--force", options->force, "Replace a data set that is there already");
    command->add_option("--threads", options->threads, "0: as many as the machine has")->check(CLI::Range(0, 1024));
    add_task_options(*command, *options);
    const CLI::Option* part = add_part_options(*command, *options);
    add_sensor_options(*command, *options);
    add_arm_options(*command, *options);
    add_fault_option(*command, *options);
    command->callback([options, part, &shared, &run] {
        const bool part_given = part->count() > 0;
        run = [options, part_given, &shared] { return simulate_recording(*options, part_given, shared); };
    });
}

}  // namespace nearpose::program
