#include "apps/data_set/bop_ground_truth.hpp"

#include "apps/data_set/bop_scene.hpp"
#include "apps/data_set/json_file.hpp"

namespace nearpose::data_set {

std::map<int, Pose> read_ground_truth(const std::filesystem::path& scene_folder, int object_id) {
    const JsonFile file(scene_folder / "scene_gt.json");
    std::map<int, Pose> poses;
    for (const auto& [frame_id, objects] : file.root().numbered_members()) {
        for (const JsonValue& object : objects.elements()) {
            if (object.at("obj_id").integer() != object_id) continue;
            poses.emplace(frame_id, read_bop_pose(object, "cam_R_m2c", "cam_t_m2c"));
            break;
        }
    }
    if (poses.empty()) throw file.root().error("no frame has object " + std::to_string(object_id));
    return poses;
}

}  // namespace nearpose::data_set
