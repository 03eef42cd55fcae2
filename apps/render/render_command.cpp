#include "apps/render/render_command.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <memory>

#include "apps/base/console.hpp"
#include "apps/base/number_text.hpp"
#include "apps/data_set/camera_json.hpp"
#include "apps/data_set/png_file.hpp"
#include "apps/data_set/pose_file.hpp"
#include "apps/part_model/model_input.hpp"
#include "raycast/depth_renderer.hpp"
#include "raycast/embree_scene.hpp"

namespace nearpose::program {
namespace {

constexpr double kDefaultScale_mm = 0.1;

struct RenderOptions {
    ModelOptions model;
    std::filesystem::path pose, camera, out;
};

int render(const RenderOptions& options, const SharedOptions& shared) {
    const data_set::CameraFile camera = data_set::read_camera_json(options.camera);
    const Pose camera_from_object = read_pose_file(options.pose);
    const EmbreeScene scene(load_model(options.model, shared));
    const DepthImage depth = render_depth(scene, camera_from_object, camera.camera);
    const double scale_mm = camera.depth_scale_mm.value_or(kDefaultScale_mm);
    const float farthest_m = *std::max_element(depth.depth_m.begin(), depth.depth_m.end());
    if (1e3 * farthest_m / scale_mm > 65535.0) {
        throw std::runtime_error(options.camera.string() + ": depth_scale " + data_set::format_number(scale_mm) +
                                 " mm is too fine for the depth of " + data_set::format_fixed(farthest_m, 3) +
                                 " m in 16 bits");
    }
    data_set::write_depth_png(options.out, depth, scale_mm);
    if (farthest_m == 0.0F) print_notice(options.out.string() + ": the model is not in view", shared.quiet);
    return kSuccess;
}

}  // namespace

void add_render_command(CLI::App& app, const SharedOptions& shared, Run& run) {
    auto options = std::make_shared<RenderOptions>();
    CLI::App* command = app.add_subcommand("render", "Depth image of a model at a pose");
    add_model_file_options(*command, options->model);
    command->get_option("--model")->required();
    command->add_option("--pose", options->pose, "Pose: JSON with cam_R_m2c, cam_t_m2c (mm)")->required();
    command->add_option("--camera", options->camera, "camera.json (cx cy fx fy width height, depth_scale or 0.1 mm)")
        ->required();
    command->add_option("--out", options->out, "Depth image to write, 16-bit PNG")->required();
    command->callback([options, &shared, &run] { run = [options, &shared] { return render(*options, shared); }; });
}

}  // namespace nearpose::program
