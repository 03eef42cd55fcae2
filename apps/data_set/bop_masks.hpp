// The masks of one object in a BOP scene: mask_visib/NNNNNN_KKKKKK.png, whatever the padding, KKKKKK being the index of
// the object in the frame's list in scene_gt.json; or mask_visib/NNNNNN.png where there is one object. Of scene_gt.json
// nothing but the order of the object numbers is kept.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "apps/data_set/bop_scene.hpp"
#include "apps/data_set/image_files.hpp"
#include "core/base/depth_image.hpp"

namespace nearpose::data_set {

struct FrameMask {
    std::optional<Mask> mask;  // of the frame's size; nullopt: the frame has none
    std::string notice;        // what is odd about it; empty: nothing
};

class MaskSource {
  public:
    // A given `mask_index` is used in every frame; else the index comes from scene_gt.json, and is 0 where there is no
    // such file. Throws std::runtime_error where scene_gt.json is broken, or no file has the given index.
    MaskSource(const BopScene& scene, int object_id, std::optional<int> mask_index = std::nullopt);

    // False for a scene without a mask_visib folder: load() then gives nothing for every frame.
    bool available() const { return available_; }

    // Throws std::runtime_error where the frame has no entry for the object in scene_gt.json.
    int mask_index_of(int frame_id) const;

    // A mask whose sides are a whole multiple or a whole part of the frame's is scaled, which is noted, as is a frame
    // without a mask. Throws std::runtime_error where the file is broken or has another size.
    FrameMask load(const Frame& frame) const;

  private:
    std::optional<std::filesystem::path> file_of(int frame_id) const;

    std::filesystem::path folder_;  // of the scene
    int object_id_;
    bool available_;
    MaskFiles files_;
    std::optional<int> fixed_index_;
    std::map<int, int> index_of_frame_;
};

}  // namespace nearpose::data_set
