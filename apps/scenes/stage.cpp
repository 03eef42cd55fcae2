#include "apps/scenes/stage.hpp"

#include "apps/scenes/bare_scene.hpp"
#include "apps/scenes/recording.hpp"

namespace nearpose::simulate {
namespace {

std::optional<StandIn> stand_in_of(const RecordingOptions& options, const Part& part, const TaskPath& path) {
    if (options.disturbances.scene != SceneContent::kOther) return std::nullopt;
    return stand_in(options.part_name, part, path, options.seed);
}

Mask none_of(const Mask& mask) {
    return {mask.width, mask.height, std::vector<std::uint8_t>(mask.value.size(), 0)};
}

}  // namespace

Stage::Stage(const Mesh& mesh, const Part& part, const RecordingOptions& options, const TaskPath& path)
    : world_(is_bare(options.disturbances.scene)
                 ? bare_world(options.disturbances.scene, part, path, options.seed)
                 : world_of(options.scenario, mesh, part, path, options.camera, options.seed,
                            {options.with_table, options.path.occlusion, options.part_name})),
      other_(stand_in_of(options, part, path)),
      scene_(other_ ? other_->mesh : mesh, world_) {}

RenderFrom Stage::from_others(const Pose& camera_from_object, const Pose& camera_from_scene, bool with_part) const {
    return
        [this, camera_from_object, camera_from_scene, with_part](const Pose& from_camera, const PinholeCamera& lens) {
            return scene_.render_from(from_camera, camera_from_object, camera_from_scene, lens, with_part);
        };
}

Sight Stage::bare_sight(const RecordingOptions& options, const Pose& camera_from_object,
                        const Pose& camera_from_scene) const {
    const SceneContent content = options.disturbances.scene;
    const InstanceView part = scene_.render(camera_from_object, camera_from_scene, options.camera).instances.front();
    Sight bare{scene_.render(camera_from_object, camera_from_scene, options.camera, false),
               blob_over(is_bare(content) ? part.silhouette : part.visible),
               from_others(camera_from_object, camera_from_scene, false)};
    if (content == SceneContent::kConstant) bare.rendered.image = with_one_depth(std::move(bare.rendered.image));
    return bare;
}

Sight Stage::sight(const RecordingOptions& options, const Pose& camera_from_object, const Pose& camera_from_scene,
                   bool there) const {
    const SceneContent content = options.disturbances.scene;
    if (content == SceneContent::kEmpty || is_bare(content))
        return bare_sight(options, camera_from_object, camera_from_scene);
    const Pose shown = other_ ? camera_from_scene * other_->scene_from_object : camera_from_object;
    Sight sight{scene_.render(shown, camera_from_scene, options.camera, there),
                {},
                from_others(shown, camera_from_scene, there)};
    InstanceView& tracked = sight.rendered.instances.front();
    sight.segmented = tracked.visible;
    if (other_) {  // of the part itself there is nothing
        tracked = {none_of(tracked.silhouette), none_of(tracked.visible), {}};
        tracked.truth.camera_from_object = camera_from_object;
    }
    return sight;
}

}  // namespace nearpose::simulate
