#include "apps/estimate/estimate_options.hpp"

#include <CLI/CLI.hpp>

#include "apps/estimate/estimate_outputs.hpp"
#include "apps/part_model/model_symmetries.hpp"
#include "apps/runs/estimator_setup.hpp"

namespace nearpose::program {
namespace {

void add_input_options(CLI::App& command, EstimateOptions& options) {
    command.add_option("--scene", options.scene, "Folder of a BOP scene: scene_camera.json, depth/, mask_visib/");
    command.add_option("--clouds", options.clouds,
                       "Instead of --scene: folder of .pcd or .ply clouds, camera frame, m");
    command.add_option("--camera", options.camera, "camera.json of --clouds (cx cy fx fy width height)");
    add_bop_model_options(command, options.model);
    add_model_file_options(command, options.model);
    command.add_flag("--no-mask", options.no_mask, "Use every measured point in range, not the mask's alone");
    command.add_flag("--mask-first-frame", options.mask_first_frame,
                     "Use the first frame's mask alone, to start with; the other frames' are left unread");
    command.add_option("--mask-index", options.mask_index, "KKKKKK of the mask files [from scene_gt.json, else 0]")
        ->check(CLI::Range(0, 999999));
    command.add_flag("--no-control", options.no_control, "Leave the measured camera motion unused");
    command.add_option("--first", options.first, "Number of the first frame [the scene's first]");
    command.add_option("--last", options.last, "Number of the last frame [the scene's last]");
    command.add_option("--scene-id", options.scene_id, "scene_id of the results [the folder's number, else 0]");
    command.add_option("--fps", options.fps, "Frames per second where the scene has no time stamps")
        ->check(CLI::Range(1e-3, 1e6));
}

void add_estimator_options(CLI::App& command, EstimateOptions& options) {
    command
        .add_option("--views", options.views,
                    "View generation: raycast, raster, raster_cells, raster_as_rays, sphere or spheres")
        ->check(CLI::IsMember(view_names()));
    command.add_option("--method", options.method, "default, or paper: the paper's formulas to the letter")
        ->check(CLI::IsMember(method_names()));
    command
        .add_option("--symmetries", options.symmetries,
                    "Of the part: auto (those of models_info.json where it has any, else as the mesh shows them), "
                    "declared (those of models_info.json alone) or none")
        ->check(CLI::IsMember(symmetry_choices()));
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
    command.add_option("--threads", options.threads, "Threads; 0: all. Results do not depend on it")
        ->check(CLI::Range(0, 4096));
    command.add_option("--seed", options.seed, "Seed of all random draws");
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
    if (options.scene.empty() == options.clouds.empty()) {
        throw BadUse(options.scene.empty() ? "an input is needed: --scene DIR, or --clouds DIR --camera camera.json"
                                           : "--scene and --clouds exclude each other");
    }
    if (options.clouds.empty() != options.camera.empty()) throw BadUse("--clouds and --camera go together");
    if (options.mask_index && options.no_mask) throw BadUse("--mask-index and --no-mask exclude each other");
    if (options.mask_first_frame && (options.no_mask || options.scene.empty())) {
        throw BadUse("--mask-first-frame belongs to the masks of a --scene");
    }
    if (options.first && options.last && *options.first > *options.last) throw BadUse("--first lies after --last");
    if (options.outputs.trajectory_frame == "world" && !options.clouds.empty()) {
        throw BadUse("--trajectory-frame world needs the camera motion of a --scene");
    }
    check(options.model);
    if (options.symmetries == "declared" && options.model.models.empty()) {
        throw BadUse("--symmetries declared needs --models, whose models_info.json holds them");
    }
}

}  // namespace nearpose::program
