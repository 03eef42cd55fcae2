// The masks of one object in a BOP scene: mask_visib/NNNNNN_KKKKKK.png, KKKKKK being the index of the object in the
// frame's list in scene_gt.json. Of scene_gt.json nothing but the order of the object numbers is kept.
#pragma once

#include <filesystem>
#include <map>
#include <optional>

#include "apps/data_set/bop_scene.hpp"
#include "core/base/depth_image.hpp"

namespace nearpose::data_set {

class MaskSource {
  public:
    // A given `mask_index` is used in every frame; else the index comes from scene_gt.json, and is 0 where there is no
    // such file. Throws std::runtime_error where scene_gt.json is broken.
    MaskSource(const BopScene& scene, int object_id, std::optional<int> mask_index = std::nullopt);

    // False for a scene without a mask_visib folder: load() then gives nullopt for every frame.
    bool available() const { return available_; }

    // Throws std::runtime_error where the frame has no entry for the object in scene_gt.json.
    int mask_index_of(int frame_id) const;

    // Throws std::runtime_error where the frame's mask is missing, broken or of another size than the frame.
    std::optional<Mask> load(const Frame& frame) const;

  private:
    std::filesystem::path folder_;  // of the scene
    int object_id_;
    bool available_;
    std::optional<int> fixed_index_;
    std::map<int, int> index_of_frame_;
};

}  // namespace nearpose::data_set
