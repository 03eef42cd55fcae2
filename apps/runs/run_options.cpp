#include "apps/runs/run_options.hpp"

#include <CLI/CLI.hpp>

#include "apps/part_model/model_symmetries.hpp"

namespace nearpose::program {

std::unique_ptr<FrameSource> open_source(const EstimateOptions& options) {
    const data_set::SceneOptions scene{options.scene_id, options.fps, options.first, options.last};
    if (options.scene.empty()) return open_cloud_source(options.clouds, options.camera, scene, !options.no_mask);
    return open_bop_source(options.scene, scene,
                           {!options.no_mask, options.model.object, options.mask_index, options.mask_first_frame});
}

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
    command.add_option("--first", options.first, "Number of the first frame [the scene's first]");
    command.add_option("--last", options.last, "Number of the last frame [the scene's last]");
    command.add_option("--scene-id", options.scene_id, "scene_id of the results [the folder's number, else 0]");
    command.add_option("--fps", options.fps, "Frames per second where the scene has no time stamps")
        ->check(CLI::Range(1e-3, 1e6));
    command
        .add_option("--symmetries", options.symmetries,
                    "Of the part: auto (those of models_info.json where it has any, else as the mesh shows them), "
                    "declared (those of models_info.json alone) or none")
        ->check(CLI::IsMember(symmetry_choices()));
    command.add_option("--threads", options.threads, "Threads; 0: all. Results do not depend on it")
        ->check(CLI::Range(0, 4096));
    command.add_option("--seed", options.seed, "Seed of all random draws");
}

void check_input(const EstimateOptions& options) {
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
    check(options.model);
    if (options.symmetries == "declared" && options.model.models.empty()) {
        throw BadUse("--symmetries declared needs --models, whose models_info.json holds them");
    }
}

}  // namespace nearpose::program
