#include "apps/estimate/estimate_options.hpp"

#include <CLI/CLI.hpp>

#include "apps/estimate/estimate_outputs.hpp"
#include "apps/runs/estimator_setup.hpp"

namespace nearpose::program {
namespace {

void add_estimator_options(CLI::App& command, EstimateOptions& options) {
    command.add_flag("--no-control", options.no_control, "Leave the measured camera motion unused");
    command.add_option("--set-up", options.set_up, "Correct the set-up by the errors that `nearpose calibrate` found");
    command.add_flag("--self-calibrate", options.self_calibrate,
                     "Find the set-up's errors in the recording first, as `nearpose calibrate` does");
    command
        .add_option("--views", options.views,
                    "View generation: raycast, raster, raster_cells, raster_as_rays, sphere or spheres")
        ->check(CLI::IsMember(view_names()));
    command.add_option("--method", options.method, "default, or paper: the paper's formulas to the letter")
        ->check(CLI::IsMember(method_names()));
    command
        .add_option("--particles", options.particles,
                    "Number of particles, the same in every frame [200, and fewer in tracking]")
        ->check(CLI::Range(1, 1000000));
    command
        .add_option("--budget-ms", options.budget_ms,
                    "Time for a frame: particles, alternatives and search candidates are left out to keep within it; "
                    "results then "
                    "depend on the machine [0: as long as it takes]")
        ->check(CLI::Range(0.0, 1e6));
    command.add_option("--initial-pose", options.initial_pose, "Start from this pose: JSON with cam_R_m2c, cam_t_m2c");
    command.add_option("--initial-sigma-mm", options.initial_sigma_mm, "Spread of the start around that pose [mm]")
        ->check(CLI::Range(0.0, 1e6));
    command.add_option("--initial-sigma-deg", options.initial_sigma_deg, "Spread of the start around that pose [deg]")
        ->check(CLI::Range(0.0, 180.0));
    command
        .add_option("--tolerance-mm", options.tolerance_mm,
                    "The verdict is `accept` only where the pose is known to within this (90 %) [mm]")
        ->check(CLI::Range(1e-6, 1e6));
    command.add_option("--tolerance-deg", options.tolerance_deg, "And to within this [deg]")
        ->check(CLI::Range(1e-6, 180.0));
}

void add_output_options(CLI::App& command, OutputOptions& options) {
    command.add_option(
        "--out", options.out,
        "BOP result file to write (bop_toolkit wants METHOD_DATASET-SPLIT.csv); - is the standard output");
    command.add_option("--run", options.run,
                       "Folder to write all of it into, and what `nearpose report` needs: poses.csv, log.jsonl, "
                       "poses.tum, particles.jsonl, run.json");
    command.add_option("--log", options.log, "Log to write: a JSON object a line");
    command.add_option("--trajectory", options.trajectory, "Trajectory to write: TUM rows, metres");
    command
        .add_option("--trajectory-frame", options.trajectory_frame,
                    "Its rows: camera (camera_from_object), object (inverse), world (world_from_object)")
        ->check(CLI::IsMember({"camera", "object", "world"}));
    command.add_option("--pictures", options.pictures, "Folder to write a picture of each frame into");
}

}  // namespace

void add_estimate_options(CLI::App& command, EstimateOptions& options) {
    add_input_options(command, options);
    add_estimator_options(command, options);
    add_output_options(command, options.outputs);
}

void check(const EstimateOptions& options) {
    check(options.outputs);
    check_input(options);
    if (!options.set_up.empty() && options.self_calibrate)
        throw BadUse("--set-up and --self-calibrate exclude each other");
    if (options.self_calibrate && options.no_control) throw BadUse("--self-calibrate needs the measured camera motion");
    if (options.outputs.trajectory_frame == "world" && !options.clouds.empty()) {
        throw BadUse("--trajectory-frame world needs the camera motion of a --scene");
    }
}

}  // namespace nearpose::program
