#include "apps/scenes/recording.hpp"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <stdexcept>

#include "apps/data_set/png_file.hpp"
#include "apps/scenes/arm_faults.hpp"
#include "apps/scenes/delivery.hpp"
#include "apps/scenes/image_faults.hpp"
#include "apps/scenes/parts.hpp"
#include "apps/scenes/stage.hpp"
#include "apps/scenes/surface_points.hpp"
#include "core/base/check.hpp"

namespace nearpose::simulate {
namespace {

constexpr double kMaxCount = 65535.0;  // of a 16-bit image

SensorNoise within_counts(SensorNoise sensor, double depth_scale_mm) {
    sensor.max_range_m = std::min(sensor.max_range_m, kMaxCount * depth_scale_mm * 1e-3);
    return sensor;
}

int measured_on(const Mask& silhouette, const DepthImage& depth) {
    int count = 0;
    for (std::size_t pixel = 0; pixel < silhouette.value.size(); ++pixel) {
        count += silhouette.value[pixel] != 0 && depth.depth_m[pixel] > 0.0F ? 1 : 0;
    }
    return count;
}

RecordingOptions checked(const RecordingOptions& options) {
    validate(options);
    return options;
}

// What the sensor makes of it.
struct Measured {
    DepthImage depth;
    std::optional<InfraredPair> infrared;
};

// What an estimator is given of it, with the faults of images.
struct Shot {
    DepthImage depth;
    Mask mask;
    std::optional<InfraredPair> infrared;
};

// camera_from_world of every frame, as the arm reports it at the image's stamp.
std::vector<Pose> reported_motion(const TaskPath& path, const RecordingOptions& options, const Delivery& delivery) {
    const std::vector<Pose> measured =
        measured_motion(path.camera_from_scene, options.arm, options.seed, options.frames_per_second);
    std::vector<Pose> reported = measured;
    for (std::size_t frame = 0; frame < measured.size(); ++frame) {
        const double stamp = delivery.stamp[frame];
        if (stamp != static_cast<double>(frame)) reported[frame] = pose_on_path(measured, stamp);
    }
    return with_arm_faults(std::move(reported), options.faults, options.seed);
}

// The first frame in which the part lies elsewhere than at the beginning.
std::optional<int> first_moved(const RecordingOptions& options) {
    std::optional<int> first = move_frame(options.disturbances, frames_on_path(options));
    for (const Fault& fault : options.faults) {
        if (fault.kind != FaultKind::kPushed && fault.kind != FaultKind::kCarried) continue;
        first = std::min(first.value_or(fault.first), fault.first);
    }
    return first;
}

// What the sensor's counts cannot hold has no depth.
DepthImage within_counts(DepthImage depth, double depth_scale_mm) {
    for (float& value_m : depth.depth_m) {
        const double count = std::round(value_m * 1e3 / depth_scale_mm);
        if (!(count >= 1.0 && count <= kMaxCount)) value_m = 0.0F;
    }
    return depth;
}

Part with_surface_points(Part part, const Mesh& mesh, Scenario scenario) {
    if (scenario == Scenario::kSweep && part.surface_points_in_object_m.empty()) {
        part.surface_points_in_object_m = surface_points_from_above(mesh);
    }
    return part;
}

}  // namespace

struct Recording::Impl {
    // Which frames there are, by their place on the path, and what happens in them.
    struct Events {
        explicit Events(const RecordingOptions& options)
            : delivery(delivery_of(frames_on_path(options), options.dropped_fraction, options.faults, options.seed)),
              moved_from(first_moved(options)),
              nonsense(nonsense_frames(options.disturbances, delivery.ids, frames_on_path(options), options.seed)) {}

        Delivery delivery;
        std::optional<int> moved_from;  // the part lies elsewhere from this frame on
        std::vector<int> nonsense;      // frames whose depth is not of the scene
    };

    // What faults remember after a frame.
    struct Memory {
        std::mutex mutex;
        int frame = -1;
        FaultMemory images;
    };

    Impl(const Mesh& mesh, const Part& part, const RecordingOptions& given)
        : options(checked(given)),
          extent(part.extent),
          events(options),
          path(task_path(options.scenario, with_surface_points(part, mesh, options.scenario), options.camera,
                         frames_on_path(options), options.seed, options.path, options.frames_per_second)),
          camera_from_world(reported_motion(path, options, events.delivery)),
          stage(mesh, part, options, path),
          sensor(within_counts(options.sensor, options.depth_scale_mm), options.camera, options.seed) {
        if (!events.moved_from) return;
        std::optional<Pose> scene_from_moved;
        if (options.disturbances.object_moves)
            scene_from_moved =
                put_down_elsewhere(stage.scene(), part, path, options.camera, *events.moved_from, options.seed);
        for (int frame = *events.moved_from; frame < frames_on_path(options); ++frame) {
            if (!options.disturbances.object_moves)
                scene_from_moved = part_motion(options.faults, path.scene_from_ground, options.seed, frame);
            const auto place = static_cast<std::size_t>(frame);
            path.camera_from_object[place] = path.camera_from_scene[place] * *scene_from_moved;
        }
    }

    Sight sight_at(int frame) const {
        const auto place = static_cast<std::size_t>(frame);
        return stage.sight(options, path.camera_from_object[place], path.camera_from_scene[place],
                           !looks_away(options.disturbances, frame, frames_on_path(options)));
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
        const int num_parts = 1 + static_cast<int>(stage.world().copies.size());
        StereoRig rig = *options.stereo;
        rig.max_range_m = within_counts(options.sensor, options.depth_scale_mm).max_range_m;
        InfraredPair infrared = infrared_images(sight.render_from, options.camera, rig, material_of(options.material),
                                                num_parts, options.seed, number);
        DepthImage depth = depth_of(infrared, options.camera, rig);
        return {std::move(depth), options.keep_infrared ? std::optional(std::move(infrared)) : std::nullopt};
    }

    // Whether a frame's own image reaches what remembers images.
    bool arrives(int frame) const {
        const Delivery& delivery = events.delivery;
        const auto place = static_cast<std::size_t>(frame);
        return std::binary_search(delivery.ids.begin(), delivery.ids.end(), frame) &&
               delivery.copy_of[place] == frame && delivery.image_of[place] == frame;
    }

    void add_faults(const Sight& sight, int frame, FaultMemory& images, Shot& shot) const {
        const SensorNoise& range = options.sensor;
        apply_faults(options.faults,
                     {sight.rendered.image, options.camera, range.min_range_m,
                      within_counts(range, options.depth_scale_mm).max_range_m, options.seed, frame},
                     images, shot.depth, shot.mask);
    }

    Shot shot_of(const Sight& sight, Measured measured, int frame) const {
        Shot shot{std::move(measured.depth), with_errors(sight.segmented, sight.rendered.image, options.mask),
                  std::move(measured.infrared)};
        if (!remembers_images(options.faults)) {
            FaultMemory none;
            add_faults(sight, frame, none, shot);
            return shot;
        }
        const std::lock_guard lock(memory.mutex);
        const auto forget = [this] {
            memory.frame = -1;
            memory.images.clear();
        };
        if (memory.frame >= frame) forget();
        for (int earlier = memory.frame + 1; earlier < frame; ++earlier) {
            if (!arrives(earlier)) continue;
            const Sight before = sight_at(earlier);
            Shot passing{measure(before, earlier).depth, before.segmented, std::nullopt};
            add_faults(before, earlier, memory.images, passing);
        }
        add_faults(sight, frame, memory.images, shot);
        memory.frame = frame;
        if (!arrives(frame)) forget();
        return shot;
    }

    // Of instance `index` of the scene; 0: such as the data set does not have.
    int object_id_at(std::size_t index) const {
        if (index > stage.world().copies.size()) return stage.world().other->object_id;
        return options.part_name.empty() ? 1 : object_id_of(options.part_name);
    }

    SimulatedFrame frame_at(int place) const;

    RecordingOptions options;
    ModelExtent extent;
    Events events;
    TaskPath path;
    std::vector<Pose> camera_from_world;
    Stage stage;
    DepthSensor sensor;
    mutable Memory memory;
};

Recording::Recording(const Mesh& mesh, const Part& part, const RecordingOptions& options)
    : impl_(std::make_unique<const Impl>(mesh, part, options)) {}
Recording::~Recording() = default;
Recording::Recording(Recording&&) noexcept = default;

int Recording::num_frames() const {
    return static_cast<int>(impl_->events.delivery.ids.size());
}

const RecordingOptions& Recording::options() const {
    return impl_->options;
}

const ModelExtent& Recording::extent() const {
    return impl_->extent;
}

SimulatedFrame Recording::frame(int index) const {
    const int id = impl_->events.delivery.ids.at(static_cast<std::size_t>(index));
    SimulatedFrame frame = impl_->frame_at(impl_->events.delivery.copy_of[static_cast<std::size_t>(id)]);
    frame.id = id;
    const std::vector<Fault>& faults = impl_->options.faults;
    frame.after_fault =
        !faults.empty() && std::all_of(faults.begin(), faults.end(), [id](const Fault& f) { return f.last < id; });
    return frame;
}

SimulatedFrame Recording::Impl::frame_at(int number) const {
    SimulatedFrame frame;
    const auto place = static_cast<std::size_t>(number);
    const int shown = events.delivery.image_of[place];
    frame.stamp_s = events.delivery.stamp[place] / options.frames_per_second;
    frame.camera = written_camera(options.camera, options.faults, number);
    frame.camera_from_object = path.camera_from_object[place];
    frame.camera_from_world = camera_from_world[place];
    frame.nonsense = std::count(events.nonsense.begin(), events.nonsense.end(), shown) > 0;
    frame.part_moved = events.moved_from && number >= *events.moved_from;
    Sight sight = sight_at(number);
    RenderedFrame& rendered = sight.rendered;
    Measured measured = measure(sight, number);
    for (std::size_t i = 0; i < rendered.instances.size(); ++i) {
        data_set::ObjectTruth& truth = rendered.instances[i].truth;
        truth.object_id = object_id_at(i);
        truth.measured_pixels = measured_on(rendered.instances[i].silhouette, measured.depth);
        if (i == 0 || truth.object_id == 0) continue;
        frame.others.push_back(
            {std::move(rendered.instances[i].visible), std::move(rendered.instances[i].silhouette), truth});
    }
    InstanceView tracked = std::move(rendered.instances.front());
    if (shown != number) {
        sight = sight_at(shown);
        measured = measure(sight, shown);
    }
    Shot shot = shot_of(sight, std::move(measured), shown);
    // Through counts and back, as through a file.
    frame.depth = data_set::depth_from_counts(
        data_set::counts_from_depth(within_counts(std::move(shot.depth), options.depth_scale_mm),
                                    options.depth_scale_mm),
        options.depth_scale_mm);
    frame.infrared = std::move(shot.infrared);
    frame.visible = std::move(tracked.visible);
    frame.silhouette = std::move(tracked.silhouette);
    frame.given_mask = std::move(shot.mask);
    frame.truth = tracked.truth;
    return frame;
}

}  // namespace nearpose::simulate
