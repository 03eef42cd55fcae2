#include "apps/scenes/recording.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "apps/base/simulation_draws.hpp"
#include "apps/data_set/png_file.hpp"
#include "apps/scenes/bare_scene.hpp"
#include "apps/scenes/parts.hpp"
#include "apps/scenes/scene.hpp"
#include "apps/scenes/surface_points.hpp"
#include "core/base/check.hpp"

namespace nearpose::simulate {
namespace {

constexpr int kMaxFrames = 100'000;
constexpr double kMaxCount = 65535.0;  // of a 16-bit image

SensorNoise within_counts(SensorNoise sensor, double depth_scale_mm) {
    sensor.max_range_m = std::min(sensor.max_range_m, kMaxCount * depth_scale_mm * 1e-3);
    return sensor;
}

int frames_of(const RecordingOptions& options) {
    return options.num_frames == 0 ? default_frames(options.scenario) : options.num_frames;
}

int measured_on(const Mask& silhouette, const DepthImage& depth) {
    int count = 0;
    for (std::size_t pixel = 0; pixel < silhouette.value.size(); ++pixel) {
        count += silhouette.value[pixel] != 0 && depth.depth_m[pixel] > 0.0F ? 1 : 0;
    }
    return count;
}

// The frames that are left, of which there are as many as the fraction says.
std::vector<int> kept_frames(const RecordingOptions& options) {
    const int count = frames_of(options);
    std::vector<std::pair<double, int>> later;  // a draw each: those with the least are dropped
    for (int frame = 1; frame < count; ++frame) {
        later.emplace_back(RandomStream(options.seed, static_cast<std::uint64_t>(frame), 0, kDropDraw).uniform(),
                           frame);
    }
    std::sort(later.begin(), later.end());
    std::vector<int> kept{0};
    for (auto it = later.begin() + num_dropped(options); it != later.end(); ++it) kept.push_back(it->second);
    std::sort(kept.begin(), kept.end());
    return kept;
}

RecordingOptions checked(const RecordingOptions& options) {
    validate(options);
    return options;
}

std::optional<StandIn> stand_in_of(const RecordingOptions& options, const Part& part, const TaskPath& path) {
    if (options.disturbances.scene != SceneContent::kOther) return std::nullopt;
    return stand_in(options.part_name, part, path, options.seed);
}

Mask none_of(const Mask& mask) {
    return {mask.width, mask.height, std::vector<std::uint8_t>(mask.value.size(), 0)};
}

// What the camera has before it, what of it a segmentation takes for the part, and the same from other viewpoints.
struct Sight {
    RenderedFrame rendered;
    Mask segmented;
    RenderFrom render_from;
};

// What the sensor makes of it.
struct Measured {
    DepthImage depth;
    std::optional<InfraredPair> infrared;
};

Part with_surface_points(Part part, const Mesh& mesh, Scenario scenario) {
    if (scenario == Scenario::kSweep && part.surface_points_in_object_m.empty()) {
        part.surface_points_in_object_m = surface_points_from_above(mesh);
    }
    return part;
}

}  // namespace

PinholeCamera default_camera() {
    return {640, 480, 600.0, 600.0, 319.5, 239.5};
}

int num_dropped(const RecordingOptions& options) {
    const int count = frames_of(options);
    return std::min(static_cast<int>(std::lround(options.dropped_fraction * count)), count - 1);
}

void validate(const RecordingOptions& options) {
    check_option("frames", frames_of(options), 1, kMaxFrames);
    check_option("frames per second", options.frames_per_second, 0.001, 1e4);
    // A depth of the least range must not round to 0 counts, which means no depth.
    check_option("depth scale [mm]", options.depth_scale_mm, 1e-4, options.sensor.min_range_m * 1e3);
    check_option("fraction of dropped frames", options.dropped_fraction, 0.0, 0.95);
    validate(options.camera);
    validate(options.path, options.scenario);
    validate(options.sensor);
    material_of(options.material);
    if (options.stereo) {
        validate(*options.stereo);
        require_stereo();
        if (options.disturbances.scene == SceneContent::kConstant)
            throw std::invalid_argument("the scene 'constant' has no infrared images: take a sensor without stereo");
    }
    validate(options.arm);
    validate(options.mask);
    validate(options.disturbances, options.scenario, frames_of(options), frames_of(options) - num_dropped(options));
}

struct Recording::Impl {
    // Which frames there are, by their place on the path, and what happens in them.
    struct Events {
        explicit Events(const RecordingOptions& options)
            : ids(kept_frames(options)),
              moved_from(move_frame(options.disturbances, frames_of(options))),
              nonsense(nonsense_frames(options.disturbances, ids, frames_of(options), options.seed)) {}

        std::vector<int> ids;
        std::optional<int> moved_from;  // the part lies elsewhere from this frame on
        std::vector<int> nonsense;      // frames whose depth is not of the scene
    };

    // What is before the camera.
    struct Stage {
        Stage(const Mesh& mesh, const Part& part, const RecordingOptions& options, const TaskPath& path)
            : world(is_bare(options.disturbances.scene)
                        ? bare_world(options.disturbances.scene, part, path, options.seed)
                        : world_of(options.scenario, mesh, part, path, options.camera, options.seed,
                                   {options.with_table, options.path.occlusion, options.part_name})),
              other(stand_in_of(options, part, path)),
              scene(other ? other->mesh : mesh, world) {}

        World world;
        std::optional<StandIn> other;  // in the part's place
        Scene scene;
    };

    Impl(const Mesh& mesh, const Part& part, const RecordingOptions& given)
        : options(checked(given)),
          extent(part.extent),
          object_id(options.part_name.empty() ? 1 : object_id_of(options.part_name)),
          events(options),
          path(task_path(options.scenario, with_surface_points(part, mesh, options.scenario), options.camera,
                         frames_of(options), options.seed, options.path, options.frames_per_second)),
          camera_from_world(
              measured_motion(path.camera_from_scene, options.arm, options.seed, options.frames_per_second)),
          stage(mesh, part, options, path),
          sensor(within_counts(options.sensor, options.depth_scale_mm), options.camera, options.seed) {
        if (!events.moved_from) return;
        const Pose scene_from_moved =
            put_down_elsewhere(stage.scene, part, path, options.camera, *events.moved_from, options.seed);
        for (auto frame = static_cast<std::size_t>(*events.moved_from); frame < path.camera_from_object.size(); ++frame)
            path.camera_from_object[frame] = path.camera_from_scene[frame] * scene_from_moved;
    }

    Sight sight_at(int frame) const {
        const auto place = static_cast<std::size_t>(frame);
        const Pose &camera_from_object = path.camera_from_object[place],
                   &camera_from_scene = path.camera_from_scene[place];
        const auto look = [&](const Pose& pose, bool with_part) {
            return stage.scene.render(pose, camera_from_scene, options.camera, with_part);
        };
        const auto render_from = [&](const Pose& pose, bool with_part) -> RenderFrom {
            return [this, pose, camera_from_scene, with_part](const Pose& from_camera, const PinholeCamera& lens) {
                return stage.scene.render_from(from_camera, pose, camera_from_scene, lens, with_part);
            };
        };
        const SceneContent content = options.disturbances.scene;
        if (content == SceneContent::kEmpty || is_bare(content)) {
            const InstanceView part = look(camera_from_object, true).instances[0];
            Sight bare{look(camera_from_object, false), blob_over(is_bare(content) ? part.silhouette : part.visible),
                       render_from(camera_from_object, false)};
            if (content == SceneContent::kConstant)
                bare.rendered.image = with_one_depth(std::move(bare.rendered.image));
            return bare;
        }
        const bool there = !looks_away(options.disturbances, frame, frames_of(options));
        const Pose shown = stage.other ? camera_from_scene * stage.other->scene_from_object : camera_from_object;
        Sight sight{look(shown, there), {}, render_from(shown, there)};
        InstanceView& tracked = sight.rendered.instances.front();
        sight.segmented = tracked.visible;
        if (stage.other) {  // of the part itself there is nothing
            tracked = {none_of(tracked.silhouette), none_of(tracked.visible), {}};
            tracked.truth.camera_from_object = camera_from_object;
        }
        return sight;
    }

    Measured measure(const Sight& sight, int frame) const {
        const auto found = std::find(events.nonsense.begin(), events.nonsense.end(), frame);
        const auto number = static_cast<std::uint64_t>(frame);
        if (found != events.nonsense.end()) {
            const bool flat = (found - events.nonsense.begin()) % 2 == 1;  // in turns
            return {nonsense_depth(options.camera, within_counts(options.sensor, options.depth_scale_mm), flat,
                                   options.seed, frame),
                    std::nullopt};
        }
        if (!options.stereo) return {sensor.measure(sight.rendered.image, number), std::nullopt};
        const int num_parts = 1 + static_cast<int>(stage.world.copies.size());
        StereoRig rig = *options.stereo;
        rig.max_range_m = within_counts(options.sensor, options.depth_scale_mm).max_range_m;
        InfraredPair infrared = infrared_images(sight.render_from, options.camera, rig, material_of(options.material),
                                                num_parts, options.seed, number);
        DepthImage depth = depth_of(infrared, options.camera, rig);
        return {std::move(depth), options.keep_infrared ? std::optional(std::move(infrared)) : std::nullopt};
    }

    // Of instance `index` of the scene; 0: such as the data set does not have.
    int object_id_at(std::size_t index) const {
        return index <= stage.world.copies.size() ? object_id : stage.world.other->object_id;
    }

    RecordingOptions options;
    ModelExtent extent;
    int object_id;
    Events events;
    TaskPath path;
    std::vector<Pose> camera_from_world;
    Stage stage;
    DepthSensor sensor;
};

Recording::Recording(const Mesh& mesh, const Part& part, const RecordingOptions& options)
    : impl_(std::make_unique<const Impl>(mesh, part, options)) {}
Recording::~Recording() = default;
Recording::Recording(Recording&&) noexcept = default;

int Recording::num_frames() const {
    return static_cast<int>(impl_->events.ids.size());
}

const RecordingOptions& Recording::options() const {
    return impl_->options;
}

const ModelExtent& Recording::extent() const {
    return impl_->extent;
}

SimulatedFrame Recording::frame(int index) const {
    const RecordingOptions& options = impl_->options;
    SimulatedFrame frame;
    frame.id = impl_->events.ids.at(static_cast<std::size_t>(index));
    const auto place = static_cast<std::size_t>(frame.id);
    frame.stamp_s = frame.id / options.frames_per_second;
    frame.camera_from_object = impl_->path.camera_from_object[place];
    frame.camera_from_world = impl_->camera_from_world[place];
    frame.nonsense = std::count(impl_->events.nonsense.begin(), impl_->events.nonsense.end(), frame.id) > 0;
    frame.part_moved = impl_->events.moved_from && frame.id >= *impl_->events.moved_from;
    Sight sight = impl_->sight_at(frame.id);
    RenderedFrame& rendered = sight.rendered;
    Measured measured = impl_->measure(sight, frame.id);
    frame.infrared = std::move(measured.infrared);
    // Through counts and back, as through a file.
    frame.depth = data_set::depth_from_counts(data_set::counts_from_depth(measured.depth, options.depth_scale_mm),
                                              options.depth_scale_mm);
    for (std::size_t i = 0; i < rendered.instances.size(); ++i) {
        data_set::ObjectTruth& truth = rendered.instances[i].truth;
        truth.object_id = impl_->object_id_at(i);
        truth.measured_pixels = measured_on(rendered.instances[i].silhouette, frame.depth);
        if (i == 0 || truth.object_id == 0) continue;
        frame.others.push_back(
            {std::move(rendered.instances[i].visible), std::move(rendered.instances[i].silhouette), truth});
    }
    InstanceView& tracked = rendered.instances.front();
    frame.visible = std::move(tracked.visible);
    frame.silhouette = std::move(tracked.silhouette);
    frame.given_mask = with_errors(sight.segmented, rendered.image, options.mask);
    frame.truth = tracked.truth;
    return frame;
}

}  // namespace nearpose::simulate
