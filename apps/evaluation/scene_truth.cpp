#include "apps/evaluation/scene_truth.hpp"

#include <map>
#include <stdexcept>

#include "apps/data_set/bop_ground_truth.hpp"
#include "apps/data_set/bop_masks.hpp"
#include "core/parallel.hpp"

namespace nearpose::evaluation {
namespace {

std::vector<Eigen::Vector3f> visible_points(const data_set::Frame& frame, const data_set::MaskSource& masks) {
    const DepthImage depth = data_set::load_depth(frame);
    const std::optional<Mask> mask = masks.load(frame);
    if (depth.width != frame.camera.width || depth.height != frame.camera.height) {
        throw std::runtime_error(frame.depth.string() + ": is not of the camera's size");
    }
    std::vector<Eigen::Vector3f> points;
    for (int pixel = 0; pixel < depth.width * depth.height; ++pixel) {
        const auto index = static_cast<std::size_t>(pixel);
        if (mask->value[index] == 0 || !(depth.depth_m[index] > 0.0F)) continue;
        const Eigen::Vector3d ray = frame.camera.ray(pixel % depth.width, pixel / depth.width);
        points.emplace_back((static_cast<double>(depth.depth_m[index]) * ray).cast<float>());
    }
    return points;
}

}  // namespace

SceneTruth read_truth(const std::filesystem::path& scene_folder, int object_id, const data_set::SceneOptions& options) {
    // Before the images are looked at: a scene without truth cannot be evaluated whatever else it has.
    const std::map<int, Pose> poses = data_set::read_ground_truth(scene_folder, object_id);
    SceneTruth truth;
    data_set::SceneOptions whole = options;
    whole.first_frame = whole.last_frame = std::nullopt;
    truth.scene = data_set::open_scene(scene_folder, whole);
    truth.object_id = object_id;
    for (const data_set::Frame& frame : truth.scene.frames) {
        if (frame.id < options.first_frame.value_or(frame.id) || frame.id > options.last_frame.value_or(frame.id)) {
            truth.frames_left_out.insert(frame.id);
            continue;
        }
        const auto pose = poses.find(frame.id);
        if (pose == poses.end()) continue;
        truth.frames.push_back({frame.id, pose->second, std::nullopt});
        truth.images.push_back(frame);
    }
    if (truth.frames.empty()) {
        throw std::runtime_error(
            (scene_folder / "scene_gt.json").string() + ": object " + std::to_string(object_id) +
            " is in none of the frames of scene_camera.json between the first and the last asked for");
    }
    return truth;
}

void add_visibility(SceneTruth& truth) {
    const data_set::MaskSource masks(truth.scene, truth.object_id);
    if (!masks.available()) {
        truth.visibility_problem = (truth.scene.folder / "mask_visib").string() + ": there is no such folder";
        return;
    }
    const std::map<int, double> fractions = data_set::read_visible_fractions(truth.scene.folder, truth.object_id);
    std::vector<std::string> problems(truth.frames.size());
    parallel_for(static_cast<int>(truth.frames.size()), 0, [&](int i) {
        const auto index = static_cast<std::size_t>(i);
        TrueFrame& frame = truth.frames[index];
        try {
            const std::vector<Eigen::Vector3f> points = visible_points(truth.images[index], masks);
            if (points.empty()) return;  // nothing to be seen: no distance, no volume
            frame.visibility = visibility_of(points);
            const auto fraction = fractions.find(frame.frame_id);
            if (fraction != fractions.end()) frame.visibility->visible_fraction = fraction->second;
        } catch (const std::runtime_error& error) {
            problems[index] = error.what();
        }
    });
    for (const std::string& problem : problems) {
        if (truth.visibility_problem.empty()) truth.visibility_problem = problem;
    }
}

}  // namespace nearpose::evaluation
