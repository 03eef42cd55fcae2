#include "apps/import/import_command.hpp"

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>

#include "apps/base/console.hpp"
#include "apps/base/number_text.hpp"
#include "apps/import/import_frames.hpp"
#include "apps/part_model/import_model.hpp"
#include "apps/part_model/model_input.hpp"
#include "apps/part_model/model_symmetries.hpp"

namespace nearpose::program {
namespace {

struct ImportOptions {
    std::filesystem::path realsense_raw, open3d, tum;
    ModelOptions model;
    std::filesystem::path camera, out;
    double depth_unit_m = 0.001;
    double units_per_metre = 5000.0;
    double fps = 30.0;
    int id = 1;
    std::optional<double> symmetry_resolution_mm;
    bool no_symmetries = false;
};

void check(const ImportOptions& options) {
    const int sources = static_cast<int>(!options.realsense_raw.empty()) + static_cast<int>(!options.open3d.empty()) +
                        static_cast<int>(!options.tum.empty()) + static_cast<int>(!options.model.model.empty());
    if (sources != 1) throw BadUse("exactly one of --realsense-raw, --open3d, --tum and --model is needed");
    const bool needs_camera = !options.realsense_raw.empty() || !options.tum.empty();
    if (needs_camera && options.camera.empty()) {
        throw BadUse("--camera is needed: such recordings do not hold the depth stream's intrinsics");
    }
    if (!needs_camera && !options.camera.empty()) throw BadUse("--camera is not used with this input");
    if (options.model.model.empty() && options.model.keep_largest) throw BadUse("--keep-largest belongs to --model");
    if (options.model.model.empty() && (options.no_symmetries || options.symmetry_resolution_mm)) {
        throw BadUse("--no-symmetries and --symmetry-resolution-mm belong to --model");
    }
    if (options.no_symmetries && options.symmetry_resolution_mm) {
        throw BadUse("--no-symmetries and --symmetry-resolution-mm exclude each other");
    }
}

// Two folders up camera.json is written, and `estimate` takes the number for the scene's.
void check_scene_folder(const std::filesystem::path& out) {
    const std::string name = (out.has_filename() ? out : out.parent_path()).filename().string();
    if (!name.empty() && name.find_first_not_of("0123456789") == std::string::npos) return;
    throw BadUse("--out " + out.string() + ": a recording goes to SET/test/NUMBER, for example mine/test/000001");
}

int report(const std::vector<std::string>& warnings, const std::string& summary, const SharedOptions& shared) {
    for (const std::string& warning : warnings) print_notice(warning, shared.quiet);
    print(summary + "\n");
    return kSuccess;
}

int import_bop_model(const ImportOptions& options, const SharedOptions& shared) {
    data_set::ModelImport import;
    import.model = options.model.model;
    import.unit = model_unit(options.model);
    import.object_id = options.id;
    import.models_folder = options.out;
    import.keep_largest = options.model.keep_largest;
    import.find_symmetries = !options.no_symmetries;
    if (options.symmetry_resolution_mm) import.symmetry_resolution_m = 1e-3 * *options.symmetry_resolution_mm;
    const data_set::ModelImportSummary summary = data_set::import_model(import);
    std::string text =
        summary.file.string() + ": diameter " + data_set::format_fixed(1e3 * summary.info.diameter_m, 2) + " mm";
    if (import.find_symmetries) text += "; symmetries: " + describe(summary.symmetries);
    return report(summary.warnings, text, shared);
}

data_set::ImportSummary import_recording(const ImportOptions& options) {
    if (!options.realsense_raw.empty()) {
        return data_set::import_realsense_raw(
            {options.realsense_raw, options.camera, options.depth_unit_m, options.out});
    }
    if (!options.tum.empty()) {
        return data_set::import_tum({options.tum, options.camera, options.units_per_metre, options.out});
    }
    return data_set::import_open3d({options.open3d, options.out, options.fps});
}

int import_any(const ImportOptions& options, const SharedOptions& shared) {
    check(options);
    if (!options.model.model.empty()) return import_bop_model(options, shared);
    check_scene_folder(options.out);
    const data_set::ImportSummary summary = import_recording(options);
    return report(summary.warnings,
                  summary.scene.string() + ": " + std::to_string(summary.frames) + " frames, depth_scale " +
                      data_set::format_number(summary.depth_scale_mm) + " mm",
                  shared);
}

}  // namespace

void add_import_command(CLI::App& app, const SharedOptions& shared, Run& run) {
    auto options = std::make_shared<ImportOptions>();
    CLI::App* command = app.add_subcommand("import", "Recordings and models of other tools into the BOP layout");
    command->add_option("--realsense-raw", options->realsense_raw, "Folder of the .raw files of `rs-convert -d -r`");
    command->add_option("--open3d", options->open3d, "Folder of Open3D frames: depth/, intrinsic.json");
    command->add_option("--tum", options->tum, "Folder of a TUM RGB-D recording: depth.txt, depth/");
    add_model_file_options(*command, options->model);
    command->add_option("--camera", options->camera, "camera.json of the depth stream (cx cy fx fy width height)");
    command->add_option("--depth-unit-m", options->depth_unit_m, "RealSense's \"Depth Units\": metres per count")
        ->check(CLI::Range(1e-7, 1.0));
    command->add_option("--units-per-metre", options->units_per_metre, "TUM's depth factor: counts per metre")
        ->check(CLI::Range(1.0, 1e7));
    command->add_option("--fps", options->fps, "Frames per second of Open3D frames")->check(CLI::Range(1e-3, 1e6));
    command->add_option("--id", options->id, "Object number of --model")->check(CLI::Range(0, 999999));
    command
        ->add_option("--symmetry-resolution-mm", options->symmetry_resolution_mm,
                     "Surfaces nearer to each other count as the same when symmetries of --model are looked for "
                     "[0.5, of large parts 0.002 diameters]")
        ->check(CLI::Range(1e-3, 1e3));
    command->add_flag("--no-symmetries", options->no_symmetries, "Write no symmetries into models_info.json");
    command->add_option("--out", options->out, "SET/test/NUMBER of a recording, SET/models of a model")->required();
    command->callback([options, &shared, &run] { run = [options, &shared] { return import_any(*options, shared); }; });
}

}  // namespace nearpose::program
