#include "apps/error_measures/scene_truth.hpp"

#include <map>
#include <stdexcept>

#include "apps/data_set/bop_ground_truth.hpp"
#include "apps/data_set/bop_masks.hpp"
#include "core/base/parallel.hpp"

namespace nearpose::evaluation {
namespace {

// Nothing where nothing of the part is to be seen.
std::optional<Visibility> visibility_in(const data_set::Frame& frame, const data_set::MaskSource& masks) {
    const DepthImage depth = data_set::load_depth(frame);
    if (depth.width != frame.camera.width || depth.height != frame.camera.height) {
        throw std::runtime_error(frame.depth.string() + ": is not of the camera's size");
    }
    const data_set::FrameMask mask = masks.load(frame);
    if (!mask.mask) throw std::runtime_error(mask.notice);
    return visibility_of(depth, *mask.mask, frame.camera);
}

}  // namespace

SceneTruth read_truth(const std::filesystem::path& scene_folder, int object_id, const data_set::SceneOptions& options,
                      std::optional<int> mask_index) {
    // Before the images are looked at: a scene without truth cannot be evaluated whatever else it has.
    const std::map<int, Pose> poses = data_set::read_ground_truth(scene_folder, object_id, mask_index);
    SceneTruth truth;
    data_set::SceneOptions whole = options;
    whole.first_frame = whole.last_frame = std::nullopt;
    truth.scene = data_set::open_scene(scene_folder, whole);
    truth.object_id = object_id;
    truth.mask_index = mask_index;
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
    const data_set::MaskSource masks(truth.scene, truth.object_id, truth.mask_index);
    if (!masks.available()) {
        truth.visibility_problem = (truth.scene.folder / "mask_visib").string() + ": there is no such folder";
        return;
    }
    const std::map<int, double> fractions =
        data_set::read_visible_fractions(truth.scene.folder, truth.object_id, truth.mask_index);
    std::vector<std::string> problems(truth.frames.size());
    parallel_for(static_cast<int>(truth.frames.size()), 0, [&](int i) {
        const auto index = static_cast<std::size_t>(i);
        TrueFrame& frame = truth.frames[index];
        try {
            frame.visibility = visibility_in(truth.images[index], masks);
            if (!frame.visibility) return;
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
