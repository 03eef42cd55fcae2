#include "apps/simulate/simulate_command.hpp"

#include <CLI/CLI.hpp>
#include <cmath>
#include <memory>

#include "apps/console.hpp"
#include "apps/data_set/camera_json.hpp"
#include "apps/model_input.hpp"
#include "apps/simulate/parts.hpp"
#include "apps/simulate/simulate.hpp"

namespace nearpose::program {
namespace {

using simulate::SimulationOptions;

// As on the command line: millimetres and degrees.
struct CommandOptions {
    ModelOptions model;
    std::filesystem::path out;
    std::string scenario = "piston";
    int frames = 0;  // 0: as many as the scenario has by itself
    double fps = 30.0;
    std::uint64_t seed = 1;
    double noise_scale = 1.0;
    std::filesystem::path camera;
    double arm_mm = 0.1;
    double arm_deg = 0.02;
    double hand_eye_mm = 0.0;
    double hand_eye_deg = 0.0;
    int threads = 0;
    bool no_table = false;
    bool force = false;
};

double radians(double degrees) {
    return degrees * M_PI / 180.0;
}

SimulationOptions simulation_options(const CommandOptions& command) {
    SimulationOptions options;
    options.data_set = command.out;
    options.replace = command.force;
    options.scenario = simulate::scenario_of(command.scenario);
    options.num_frames = command.frames == 0 ? simulate::default_frames(options.scenario) : command.frames;
    options.frames_per_second = command.fps;
    options.seed = command.seed;
    if (!command.camera.empty()) {
        const data_set::CameraFile file = data_set::read_camera_json(command.camera);
        options.camera = file.camera;
        if (file.depth_scale_mm) options.depth_scale_mm = *file.depth_scale_mm;
    }
    options.sensor = simulate::scaled({}, command.noise_scale);
    options.arm = {command.arm_mm * 1e-3, radians(command.arm_deg), command.hand_eye_mm * 1e-3,
                   radians(command.hand_eye_deg)};
    options.with_table = !command.no_table;
    options.num_threads = command.threads;
    return options;
}

int simulate_recording(const CommandOptions& command, const SharedOptions& shared) {
    const SimulationOptions options = simulation_options(command);
    const bool embedded = command.model.model.empty();
    if (embedded && !command.model.unit.empty())
        throw BadUse("--unit belongs to --model: the built-in part needs none");
    const Mesh mesh = embedded ? simulate::embedded_part("engine_block").mesh : load_model(command.model, shared);
    const ModelExtent extent = extent_of(mesh);
    const simulate::Part part = embedded ? simulate::engine_block_part(extent) : simulate::box_part(extent);

    Progress progress("simulate", options.num_frames, shared.quiet);
    const simulate::SimulationSummary summary = simulate::write_data_set(mesh, part, options, [&progress] {
        progress.step();
        return !interrupted();
    });
    if (!summary.complete) return kInterrupted;
    if (summary.frames_without_part > 0) {
        print_notice(std::to_string(summary.frames_without_part) +
                         " frames have no depth on the part: it is out of view or out of the sensor's range",
                     shared.quiet);
    }
    return kSuccess;
}

void add_options(CLI::App& command, CommandOptions& options) {
    add_model_file_options(command, options.model);
    command.get_option("--model")->description("Model file; without it the built-in engine block");
    command.add_option("--out", options.out, "Folder of the BOP data set to write")->required();
    command.add_option("--scenario", options.scenario, "baseline: still, whole part in view; piston: down to a bore")
        ->check(CLI::IsMember(simulate::scenario_names()));
    command.add_option("--seed", options.seed, "Same seed, same files");
    command.add_option("--frames", options.frames, "Number of frames; 0: 60 for piston, 30 for baseline")
        ->check(CLI::Range(0, 100000));
    command.add_option("--fps", options.fps, "Frames per second")->check(CLI::Range(0.001, 10000.0));
    command.add_option("--noise-scale", options.noise_scale, "Times the sensor's faults; 0: exact depth")
        ->check(CLI::Range(0.0, 100.0));
    command
        .add_option("--camera", options.camera, "camera.json; without it 640x480 with fx = fy = 600, 0.1 mm a count")
        ->check(CLI::ExistingFile);
    command.add_option("--arm-mm", options.arm_mm, "Noise of the reported camera position, standard deviation an axis")
        ->check(CLI::Range(0.0, 1000.0));
    command.add_option("--arm-deg", options.arm_deg, "Noise of the reported orientation, standard deviation an axis")
        ->check(CLI::Range(0.0, 45.0));
    command.add_option("--hand-eye-mm", options.hand_eye_mm, "Constant error of the reported position")
        ->check(CLI::Range(0.0, 1000.0));
    command.add_option("--hand-eye-deg", options.hand_eye_deg, "Constant error of the reported orientation")
        ->check(CLI::Range(0.0, 45.0));
    command.add_option("--threads", options.threads, "0: as many as the machine has")->check(CLI::Range(0, 1024));
    command.add_flag("--no-table", options.no_table, "Leave out the table that the part stands on");
    command.add_flag("--force", options.force, "Replace a data set that is there already");
}

}  // namespace

void add_simulate_command(CLI::App& app, const SharedOptions& shared, Run& run) {
    auto options = std::make_shared<CommandOptions>();
    CLI::App* command = app.add_subcommand("simulate", "Simulated depth recording of a part, as a BOP data set");
    add_options(*command, *options);
    command->callback(
        [options, &shared, &run] { run = [options, &shared] { return simulate_recording(*options, shared); }; });
}

}  // namespace nearpose::program
