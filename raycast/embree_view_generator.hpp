// Views by ray casting: the surface that each pixel's ray meets first.
#pragma once

#include "core/view_generator.hpp"
#include "raycast/embree_scene.hpp"

namespace nearpose {

// One ray for each pixel of the camera: visibility, perspective and the image's border are those of the real camera in
// all six degrees of freedom, and normals are exact.
class EmbreeViewGenerator : public ViewGenerator {
  public:
    explicit EmbreeViewGenerator(const Mesh& mesh);

    View generate(const Pose& camera_from_object, const PinholeCamera& camera) const override;
    const ModelExtent& extent() const override { return scene_.extent(); }
    const EmbreeScene& scene() const { return scene_; }

  private:
    EmbreeScene scene_;
};

}  // namespace nearpose
