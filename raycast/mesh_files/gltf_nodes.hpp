// The nodes of a glTF document, which place meshes and other nodes, and its scenes, which list nodes.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "raycast/mesh_files/gltf_fields.hpp"

namespace nearpose {

// Each of the functions checks one item and returns it as it is written again: first every node, then the count of
// instances, then every scene.
class GltfNodes {
  public:
    // `fields` must live longer. `count` is the number of nodes in the document.
    GltfNodes(const GltfFields& fields, std::size_t count) : fields_(fields), count_(count) {}

    std::string node(const JsonValue& item, std::size_t num_meshes);
    // Refuses nodes that contain themselves, are nested too deeply or placed too often.
    void count_instances();
    std::string scene(const JsonValue& item);

    std::int64_t num_scenes() const { return num_scenes_; }

  private:
    const GltfFields& fields_;
    std::size_t count_;
    std::vector<std::vector<std::size_t>> children_;
    std::vector<std::int64_t> instances_;  // how many nodes stand below each, itself included
    std::int64_t scene_instances_ = 0;
    std::int64_t num_scenes_ = 0;
};

}  // namespace nearpose
