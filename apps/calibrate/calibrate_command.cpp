#include "apps/calibrate/calibrate_command.hpp"

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "apps/base/console.hpp"
#include "apps/base/number_text.hpp"
#include "apps/calibrate/setup_table.hpp"
#include "apps/runs/estimator_start.hpp"
#include "apps/runs/run_options.hpp"
#include "apps/set_up/calibration.hpp"
#include "apps/set_up/setup_file.hpp"

namespace nearpose::program {
namespace {

struct CalibrateOptions {
    EstimateOptions input;
    std::filesystem::path out;
    int passes = CalibrationOptions{}.passes;
    std::vector<std::string> unknown;  // none: the recording decides
};

// The part's place cannot be compared where the arm's poses are missing.
void require_arm_poses(const EstimateOptions& options, const FrameSource& source) {
    for (const FrameInfo& frame : source.frames()) {
        if (frame.camera_from_world) return;
    }
    throw std::runtime_error(options.scene.string() +
                             ": a set-up is calibrated by the arm's poses: write cam_R_w2c and cam_t_w2c into "
                             "scene_camera.json");
}

std::string headline(const Calibration& calibration) {
    std::string parts;
    for (const std::string& part : calibration.unknown) parts += (parts.empty() ? "" : ", ") + part;
    return "set-up from " + std::to_string(calibration.sightings) + " sightings of the part in " +
           std::to_string(calibration.frames) + " frames; they scatter " +
           data_set::format_fixed(calibration.unit_sigma, 1) + " times as far as their covariances say\n" +
           (parts.empty() ? std::string("nothing seems at fault\n") : "what may be at fault: " + parts + "\n");
}

int tell(const Calibration& calibration, const FrameSource& source, const CalibrateOptions& options,
         const SharedOptions& shared) {
    if (interrupted()) {
        print_error("interrupted: nothing was calibrated");
        return kInterrupted;
    }
    if (calibration.mistake != MotionMistake::kNone) {
        print_error("the image moves " + std::string(to_string(calibration.mistake)) +
                    "; mend that first, then calibrate");
        return kFailure;
    }
    if (!calibration.solved) {
        print_error("the part was seen in too few frames of known motion (" + std::to_string(calibration.sightings) +
                    "); record an approach of 60 frames to a part that stands still");
        return kFailure;
    }
    constexpr double kScattered = 3.0;
    if (calibration.unit_sigma > kScattered)
        print_notice("the sightings scatter far: did the part move, or is something else wrong?", shared.quiet);
    print(headline(calibration) + "\n" + setup_table(calibration) + "\n" +
          advice_of(calibration, source.frames().front().camera));
    if (!options.out.empty()) {
        write_setup_file(options.out, calibration);
        print_notice("`nearpose estimate --set-up " + options.out.string() + "` corrects a recording by it",
                     shared.quiet);
    }
    return kSuccess;
}

int calibrate_recording(const CalibrateOptions& options, const SharedOptions& shared) {
    check_input(options.input);
    const std::shared_ptr<const FrameSource> source = open_source(options.input);
    require_arm_poses(options.input, *source);
    const Mesh mesh = load_model(options.input.model, shared);
    const EstimatorSetup setup = setup_of(options.input, mesh, shared);
    const std::shared_ptr<const ViewGenerator> views = make_view_generator(setup, mesh);
    CalibrationOptions calibration;
    calibration.passes = options.passes;
    if (!options.unknown.empty()) calibration.unknown = options.unknown;
    Progress progress("calibrate", options.passes * static_cast<int>(source->frames().size()), shared.quiet);
    const Calibration found = calibrate(
        source, extent_of(mesh).centre_in_object(), setup, views,
        [&] {
            progress.step();
            return !interrupted();
        },
        calibration);
    return tell(found, *source, options, shared);
}

}  // namespace

void add_calibrate_command(CLI::App& app, const SharedOptions& shared, Run& run) {
    auto options = std::make_shared<CalibrateOptions>();
    CLI::App* command = app.add_subcommand(
        "calibrate", "Errors of camera, hand-eye calibration and clocks, from an approach to a part that stands still");
    add_input_options(*command, options->input);
    command
        ->add_option("--passes", options->passes,
                     "At most so many passes over the recording, each corrected by the last")
        ->check(CLI::Range(1, 20));
    command
        ->add_option(
            "--unknown", options->unknown,
            "What may be at fault, a list; the rest is taken to be as good as a set-up usually is, which makes "
            "the others more precise")
        ->delimiter(',')
        ->check(CLI::IsMember(setup_parts()));
    command->add_option("--out", options->out,
                        "File to write the errors into (JSON), for `nearpose estimate --set-up`");
    command->callback(
        [options, &shared, &run] { run = [options, &shared] { return calibrate_recording(*options, shared); }; });
}

}  // namespace nearpose::program
