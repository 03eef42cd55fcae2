// What is before the camera in a frame, by what a recording's options ask for.
#pragma once

#include <optional>

#include "apps/depth_sensor/dot_projector.hpp"
#include "apps/scenes/disturbance.hpp"
#include "apps/scenes/scene.hpp"
#include "apps/scenes/world.hpp"

namespace nearpose::simulate {

struct RecordingOptions;

// What the camera has before it, what of it a segmentation takes for the part, and the same from other viewpoints.
struct Sight {
    RenderedFrame rendered;
    Mask segmented;
    RenderFrom render_from;  // lives no longer than the stage
};

// Immutable; may be used from several threads at once.
class Stage {
  public:
    Stage(const Mesh& mesh, const Part& part, const RecordingOptions& options, const TaskPath& path);

    // With the poses of the frame; `there`: whether the part is in view.
    Sight sight(const RecordingOptions& options, const Pose& camera_from_object, const Pose& camera_from_scene,
                bool there) const;

    const World& world() const { return world_; }
    const Scene& scene() const { return scene_; }

  private:
    Sight bare_sight(const RecordingOptions& options, const Pose& camera_from_object,
                     const Pose& camera_from_scene) const;
    RenderFrom from_others(const Pose& camera_from_object, const Pose& camera_from_scene, bool with_part) const;

    World world_;
    std::optional<StandIn> other_;  // in the part's place
    Scene scene_;
};

}  // namespace nearpose::simulate
