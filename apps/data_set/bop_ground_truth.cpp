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

std::map<int, double> read_visible_fractions(const std::filesystem::path& scene_folder, int object_id) {
    const std::filesystem::path path = scene_folder / "scene_gt_info.json";
    std::map<int, double> fractions;
    if (!std::filesystem::exists(path)) return fractions;
    const JsonFile truth(scene_folder / "scene_gt.json"), file(path);
    std::map<int, std::vector<JsonValue>> infos;
    for (const auto& [frame_id, objects] : file.root().numbered_members()) infos.emplace(frame_id, objects.elements());
    for (const auto& [frame_id, objects] : truth.root().numbered_members()) {
        const std::vector<JsonValue> listed = objects.elements();
        for (std::size_t i = 0; i < listed.size(); ++i) {
            if (listed[i].at("obj_id").integer() != object_id) continue;
            const auto found = infos.find(frame_id);
            if (found == infos.end() || i >= found->second.size()) {
                throw file.root().error("frame " + std::to_string(frame_id) + " lacks an object of scene_gt.json");
            }
            const JsonValue fraction = found->second[i].at("visib_fract");
            fractions.emplace(frame_id, fraction.number());
            // Outside of it stands for a silhouette that is empty.
            if (!(fraction.number() >= 0.0 && fraction.number() <= 1.0)) fractions.erase(frame_id);
            break;
        }
    }
    return fractions;
}

}  // namespace nearpose::data_set
