// The part and what stands around it, rendered with what the ground truth says of them.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "apps/data_set/bop_writer.hpp"
#include "apps/scenes/world.hpp"
#include "core/base/camera.hpp"
#include "core/base/depth_image.hpp"
#include "core/base/pose.hpp"
#include "raycast/depth_renderer.hpp"
#include "raycast/embree_scene.hpp"

namespace nearpose::simulate {

inline constexpr int kPartIndex = 0;  // in RenderedImage::object; other instances, table and things follow

// A part in an image. The truth lacks measured_pixels and object_id, which the sensor and the data set decide.
struct InstanceView {
    Mask silhouette;              // pixels whose ray meets it
    Mask visible;                 // of these, where nothing is before it
    data_set::ObjectTruth truth;  //
};

struct RenderedFrame {
    RenderedImage image;                  // exact depth; object as above, -1 for nothing
    std::vector<InstanceView> instances;  // the tracked part, its copies, the other part
};

// Immutable; render may be called from several threads at once.
class Scene {
  public:
    Scene(const Mesh& part, const World& world);

    // Without the part, what is known of it is that nothing is to be seen.
    RenderedFrame render(const Pose& camera_from_object, const Pose& camera_from_scene, const PinholeCamera& camera,
                         bool with_part = true) const;

    // The image alone, from another viewpoint than that of the camera, to which the gripper is fixed. `lens` has the
    // intrinsics there.
    RenderedImage render_from(const Pose& viewpoint_from_camera, const Pose& camera_from_object,
                              const Pose& camera_from_scene, const PinholeCamera& lens, bool with_part = true) const;

    const EmbreeScene& part() const { return part_; }

  private:
    EmbreeScene part_;
    std::vector<Pose> scene_from_copies_;
    std::optional<Table> table_;
    std::optional<EmbreeScene> other_, surroundings_, gripper_;
    Pose scene_from_other_;
};

// The pixels, also outside the image, that a part's box covers. Ends two image sizes from the image: of a part that
// reaches farther, or behind the camera, only so much is counted.
PixelBox silhouette_canvas(const ModelExtent& extent, const Pose& camera_from_object, const PinholeCamera& camera);

}  // namespace nearpose::simulate
