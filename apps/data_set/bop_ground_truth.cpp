#include "apps/data_set/bop_ground_truth.hpp"

#include "apps/data_set/bop_pose.hpp"
#include "apps/data_set/json_file.hpp"

namespace nearpose::data_set {
namespace {

// Where in a frame's list the instance stands that counts.
std::optional<std::size_t> place_of(const std::vector<JsonValue>& listed, int object_id, std::optional<int> index) {
    for (std::size_t i = 0; i < listed.size(); ++i) {
        if (index && i != static_cast<std::size_t>(*index)) continue;
        if (listed[i].at("obj_id").integer() == object_id) return i;
    }
    return std::nullopt;
}

}  // namespace

std::map<int, Pose> read_ground_truth(const std::filesystem::path& scene_folder, int object_id,
                                      std::optional<int> index) {
    const JsonFile file(scene_folder / "scene_gt.json");
    std::map<int, Pose> poses;
    for (const auto& [frame_id, objects] : file.root().numbered_members()) {
        const std::vector<JsonValue> listed = objects.elements();
        const auto place = place_of(listed, object_id, index);
        if (place) poses.emplace(frame_id, read_bop_pose(listed[*place], "cam_R_m2c", "cam_t_m2c"));
    }
    const std::string where = index ? " at index " + std::to_string(*index) : "";
    if (poses.empty()) throw file.root().error("no frame has object " + std::to_string(object_id) + where);
    return poses;
}

std::map<int, double> read_visible_fractions(const std::filesystem::path& scene_folder, int object_id,
                                             std::optional<int> index) {
    const std::filesystem::path path = scene_folder / "scene_gt_info.json";
    std::map<int, double> fractions;
    if (!std::filesystem::exists(path)) return fractions;
    const JsonFile truth(scene_folder / "scene_gt.json"), file(path);
    std::map<int, std::vector<JsonValue>> infos;
    for (const auto& [frame_id, objects] : file.root().numbered_members()) infos.emplace(frame_id, objects.elements());
    for (const auto& [frame_id, objects] : truth.root().numbered_members()) {
        const auto place = place_of(objects.elements(), object_id, index);
        if (!place) continue;
        const auto found = infos.find(frame_id);
        if (found == infos.end() || *place >= found->second.size()) {
            throw file.root().error("frame " + std::to_string(frame_id) + " lacks an object of scene_gt.json");
        }
        const double fraction = found->second[*place].at("visib_fract").number();
        // Another number stands for a silhouette that is empty.
        if (fraction >= 0.0 && fraction <= 1.0) fractions.emplace(frame_id, fraction);
    }
    return fractions;
}

}  // namespace nearpose::data_set
