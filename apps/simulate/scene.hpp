// The part on its table, rendered with what the ground truth says of it.
#pragma once

#include <optional>

#include "apps/data_set/bop_writer.hpp"
#include "core/camera.hpp"
#include "core/depth_image.hpp"
#include "core/pose.hpp"
#include "raycast/depth_renderer.hpp"
#include "raycast/embree_scene.hpp"

namespace nearpose::simulate {

inline constexpr int kPartIndex = 0;   // in RenderedImage::object
inline constexpr int kTableIndex = 1;  //

struct RenderedFrame {
    RenderedImage image;          // exact depth; object as above, -1 for nothing
    Mask silhouette;              // pixels whose ray meets the part
    Mask visible;                 // of these, where nothing is before the part
    data_set::ObjectTruth truth;  // but for measured_pixels and object_id, which the sensor and the data set decide
};

// Immutable; render may be called from several threads at once.
class Scene {
  public:
    // The table's top lies at the part's lowest point, its normal along the object's z.
    Scene(const Mesh& part, bool with_table);

    RenderedFrame render(const Pose& camera_from_object, const PinholeCamera& camera) const;

    const ModelExtent& extent() const { return part_.extent(); }

  private:
    EmbreeScene part_;
    std::optional<EmbreeScene> table_;
};

// The image plane around an image, as far as the part's box reaches, so that the silhouette is counted whole. Ends two
// image sizes from the image: of a part that reaches farther, or behind the camera, only so much is counted.
PixelBox silhouette_canvas(const ModelExtent& extent, const Pose& camera_from_object, const PinholeCamera& camera);

}  // namespace nearpose::simulate
