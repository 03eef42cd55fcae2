#include "tests/bench/peer_runs.hpp"

#include <numbers>

#include "apps/data_set/model_diameter.hpp"
#include "apps/depth_sensor/sensor_file.hpp"
#include "apps/error_measures/frame_errors.hpp"
#include "apps/part_model/model_symmetries.hpp"
#include "apps/scenes/parts.hpp"
#include "core/estimator.hpp"
#include "core/search/sampling.hpp"
#include "optim/ceres_pose_solver.hpp"
#include "raycast/embree_view_generator.hpp"

namespace nearpose::bench {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

class Means {
  public:
    Means(const PeerScene& scene, int first) : scene_(scene), first_(first) {}

    void add(int index, const Pose& pose) {
        if (index < first_) return;
        const simulate::SimulatedFrame& frame = scene_.frames[static_cast<std::size_t>(index)];
        const evaluation::PoseErrors errors = evaluation::pose_error(pose, frame.camera_from_object, scene_.info);
        ++sums_.frames;
        sums_.translation_mm += 1e3 * errors.translation_m;
        sums_.rotation_deg += kDegrees * errors.rotation_rad;
        sums_.depth_mm += 1e3 * errors.translation_in_camera_m.z();
        sums_.explained +=
            naive::explained_share(pose, *scene_.single_rays, frame.depth, frame.visible, scene_.camera, kExplained_m);
    }
    FitErrors get() const {
        FitErrors means = sums_;
        for (double* sum : {&means.translation_mm, &means.rotation_deg, &means.depth_mm, &means.explained})
            *sum /= std::max(1, means.frames);
        return means;
    }

  private:
    const PeerScene& scene_;
    int first_;
    FitErrors sums_;
};

constexpr Diffusion kStart{0.5 / kDegrees, 0.001};

Pose start_near(const PeerScene& scene, int index) {
    const Pose& truth = scene.frames[static_cast<std::size_t>(index)].camera_from_object;
    constexpr std::uint64_t kSeed = 1;
    return sample_around(truth, kStart, scene.views->extent(), 2, kSeed, static_cast<std::uint64_t>(index))
        .poses.back();
}

struct Prepared {
    PoseEstimator estimator;
    ObservationOptions observation;
};

Prepared prepare(const PeerScene& scene, const Change& change) {
    EstimatorOptions options;
    options.num_threads = 1;
    options.symmetries = scene.symmetries;
    ObservationOptions observation;
    change(options.method, observation.sensor);
    return {PoseEstimator(scene.views, std::make_shared<CeresPoseSolver>(), options), observation};
}

Observation observe(const PeerScene& scene, const simulate::SimulatedFrame& frame, bool with_mask,
                    const ObservationOptions& options) {
    return make_observation(frame.depth, scene.camera, with_mask ? std::optional<Mask>(frame.given_mask) : std::nullopt,
                            options);
}

}  // namespace

PeerScene::PeerScene(const PeerCase& of) {
    const simulate::EmbeddedPart part = simulate::embedded_part(of.part);
    simulate::RecordingOptions options;
    options.scenario = simulate::scenario_of(of.scenario);
    options.num_frames = of.frames;
    options.seed = of.seed;
    if (of.far_m > 0.0) options.path.far_m = of.far_m;
    if (of.near_m > 0.0) options.path.near_m = of.near_m;
    const simulate::SensorDescription sensor = simulate::read_sensor(of.sensor);
    options.camera = sensor.camera;
    options.depth_scale_mm = sensor.depth_scale_mm;
    options.sensor = sensor.noise;
    options.stereo = sensor.stereo;
    if (options.stereo && of.min_range_m > 0.0)
        options.stereo->min_range_m = options.sensor.min_range_m = of.min_range_m;
    options.part_name = of.part;
    const simulate::Recording recording(part.mesh, part.part, options);
    camera = options.camera;
    symmetries = program::find_symmetries(part.mesh);
    info.diameter_m = data_set::diameter_of(part.mesh.vertices_in_object);
    info.box_min_in_object_m = part.part.extent.box_min_in_object;
    info.box_max_in_object_m = part.part.extent.box_max_in_object;
    program::declare(symmetries, info);
    views = std::make_shared<EmbreeViewGenerator>(part.mesh);
    single_rays = std::make_unique<naive::SingleRayViews>(part.mesh);
    for (int k = 0; k < recording.num_frames(); ++k) frames.push_back(recording.frame(k));
}

FitErrors tracked(const PeerScene& scene, bool with_mask, int first, const Change& change) {
    Prepared prepared = prepare(scene, change);
    Means means(scene, first);
    std::optional<Pose> camera_from_world_before;
    for (int k = 0; k < static_cast<int>(scene.frames.size()); ++k) {
        const simulate::SimulatedFrame& frame = scene.frames[static_cast<std::size_t>(k)];
        std::optional<Pose> now_from_before;
        if (camera_from_world_before) now_from_before = frame.camera_from_world * camera_from_world_before->inverse();
        camera_from_world_before = frame.camera_from_world;
        const UpdateResult result =
            prepared.estimator.update(observe(scene, frame, with_mask, prepared.observation), now_from_before);
        if (result.status != UpdateStatus::kNoPose) means.add(k, result.camera_from_object);
    }
    return means.get();
}

FitErrors started_near(const PeerScene& scene, bool with_mask, int first, const Change& change) {
    Prepared prepared = prepare(scene, change);
    Means means(scene, first);
    for (int k = first; k < static_cast<int>(scene.frames.size()); ++k) {
        const simulate::SimulatedFrame& frame = scene.frames[static_cast<std::size_t>(k)];
        prepared.estimator.reset(start_near(scene, k), kStart);
        const UpdateResult result =
            prepared.estimator.update(observe(scene, frame, with_mask, prepared.observation), std::nullopt);
        if (result.status != UpdateStatus::kNoPose) means.add(k, result.camera_from_object);
    }
    return means.get();
}

FitErrors plainly_fitted(const PeerScene& scene, bool with_mask, int first, const naive::PlaneFitOptions& options) {
    Means means(scene, first);
    for (int k = first; k < static_cast<int>(scene.frames.size()); ++k) {
        const simulate::SimulatedFrame& frame = scene.frames[static_cast<std::size_t>(k)];
        means.add(k, naive::fit_point_to_plane(start_near(scene, k), *scene.single_rays, frame.depth,
                                               with_mask ? &frame.given_mask : nullptr, scene.camera, options));
    }
    return means.get();
}

double explained_by_truth(const PeerScene& scene, int first) {
    Means means(scene, first);
    for (int k = first; k < static_cast<int>(scene.frames.size()); ++k)
        means.add(k, scene.frames[static_cast<std::size_t>(k)].camera_from_object);
    return means.get().explained;
}

}  // namespace nearpose::bench
