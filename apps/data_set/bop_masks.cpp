#include "apps/data_set/bop_masks.hpp"

#include <stdexcept>
#include <string>

#include "apps/data_set/png_file.hpp"

namespace nearpose::data_set {

MaskSource::MaskSource(const BopScene& scene, int object_id, std::optional<int> mask_index)
    : folder_(scene.folder),
      object_id_(object_id),
      available_(std::filesystem::is_directory(scene.folder / "mask_visib")),
      fixed_index_(mask_index) {
    if (fixed_index_ || !available_) return;
    const std::filesystem::path truth = folder_ / "scene_gt.json";
    if (!std::filesystem::exists(truth)) {
        fixed_index_ = 0;
        return;
    }
    const JsonFile file(truth);
    for (const auto& [frame_id, objects] : file.root().numbered_members()) {
        int index = 0;
        for (const JsonValue& object : objects.elements()) {
            // Of several instances the first, which emplace keeps.
            if (object.at("obj_id").integer() == object_id) index_of_frame_.emplace(frame_id, index);
            ++index;
        }
    }
}

int MaskSource::mask_index_of(int frame_id) const {
    if (fixed_index_) return *fixed_index_;
    const auto found = index_of_frame_.find(frame_id);
    if (found == index_of_frame_.end()) {
        throw std::runtime_error((folder_ / "scene_gt.json").string() + ": " + std::to_string(frame_id) + ": object " +
                                 std::to_string(object_id_) +
                                 " is not listed, so its mask has no number: give --mask-index or --no-mask");
    }
    return found->second;
}

std::optional<Mask> MaskSource::load(const Frame& frame) const {
    if (!available_) return std::nullopt;
    return read_mask_png(mask_path(folder_, frame.id, mask_index_of(frame.id)), frame.camera.width,
                         frame.camera.height);
}

}  // namespace nearpose::data_set
