#include "apps/compare/filter_run.hpp"

#include <map>

#include "apps/base/thread_time.hpp"
#include "apps/error_measures/scene_truth.hpp"
#include "apps/runs/frame_source.hpp"

namespace nearpose::compare {
namespace {

FilterFrame frame_of(const simulate::Recording& recording, int index) {
    const simulate::SimulatedFrame frame = recording.frame(index);
    const PinholeCamera& camera = recording.options().camera;
    const evaluation::TrueFrame truth{frame.id, frame.camera_from_object,
                                      evaluation::visibility_of(frame.depth, frame.visible, camera)};
    return {frame.id, make_observation(frame.depth, camera, frame.given_mask), frame.camera_from_world, truth};
}

PoseEstimator make_estimator(const ComparedFilter& filter, std::uint64_t seed) {
    program::EstimatorSetup setup;
    setup.method = filter.method;
    setup.particles = filter.particles;
    setup.threads = 1;
    setup.seed = seed;
    return program::make_estimator(setup, filter.generator);
}

evaluation::FrameErrors errors_of(const evaluation::TrueFrame& truth, const UpdateResult& result, double time_s,
                                  const data_set::ModelInfo& model) {
    evaluation::FrameErrors errors;
    errors.frame_id = truth.frame_id;
    errors.visibility = truth.visibility;
    errors.time_s = time_s;
    if (result.status == UpdateStatus::kNoPose) return errors;
    errors.errors = evaluation::pose_error(result.camera_from_object, truth.camera_from_object, model);
    errors.score = result.score;
    errors.predicted = result.status == UpdateStatus::kPredicted;
    return errors;
}

}  // namespace

FilterRecording sweep_recording(const simulate::EmbeddedPart& part, const std::string& part_name, double far_m,
                                double near_m, int num_frames, std::uint64_t seed) {
    simulate::RecordingOptions options;
    options.scenario = simulate::Scenario::kSweep;
    options.path.far_m = far_m;
    options.path.near_m = near_m;
    options.num_frames = num_frames;
    options.seed = seed;
    options.part_name = part_name;
    const auto simulated = std::make_shared<const simulate::Recording>(part.mesh, part.part, options);
    FilterRecording recording;
    recording.model.diameter_m = part.part.extent.diameter_m();
    recording.model.box_min_in_object_m = part.part.extent.box_min_in_object;
    recording.model.box_max_in_object_m = part.part.extent.box_max_in_object;
    recording.num_frames = simulated->num_frames();
    recording.frame = [simulated](int index) { return frame_of(*simulated, index); };
    return recording;
}

FilterRecording scene_recording(const std::filesystem::path& scene, const std::filesystem::path& models,
                                int object_id) {
    FilterRecording recording;
    recording.model = data_set::read_model_info(models, object_id);
    evaluation::SceneTruth truth = evaluation::read_truth(scene, object_id);
    evaluation::add_visibility(truth);
    std::map<int, evaluation::TrueFrame> truth_of;
    for (const evaluation::TrueFrame& frame : truth.frames) truth_of.emplace(frame.frame_id, frame);
    const std::shared_ptr<const program::FrameSource> source =
        program::open_bop_source(scene, {}, {true, object_id, std::nullopt});
    recording.num_frames = static_cast<int>(source->frames().size());
    recording.frame = [source, truth_of](int index) {
        const auto place = static_cast<std::size_t>(index);
        const program::FrameInfo& info = source->frames()[place];
        FilterFrame frame{info.id, program::observe_frame(info, source->load(place)), info.camera_from_world, {}};
        const auto known = truth_of.find(info.id);
        if (known != truth_of.end()) frame.truth = known->second;
        return frame;
    };
    return recording;
}

std::vector<std::vector<evaluation::FrameErrors>> run_filters(const FilterRecording& recording,
                                                              const std::vector<ComparedFilter>& filters,
                                                              std::uint64_t seed, const std::function<bool()>& go_on) {
    std::vector<PoseEstimator> estimators;
    for (const ComparedFilter& filter : filters) estimators.push_back(make_estimator(filter, seed));
    std::vector<std::vector<evaluation::FrameErrors>> errors(filters.size());
    std::optional<Pose> camera_from_world_before;
    for (int index = 0; index < recording.num_frames; ++index) {
        if (!go_on()) return {};
        const FilterFrame frame = recording.frame(index);
        std::optional<Pose> now_from_before;
        if (frame.camera_from_world && camera_from_world_before) {
            now_from_before = *frame.camera_from_world * camera_from_world_before->inverse();
        }
        camera_from_world_before = frame.camera_from_world;
        for (std::size_t k = 0; k < filters.size(); ++k) {
            const double begin_s = thread_cpu_s();
            const UpdateResult result = estimators[k].update(frame.observation, now_from_before);
            const double time_s = thread_cpu_s() - begin_s;
            if (frame.truth) errors[k].push_back(errors_of(*frame.truth, result, time_s, recording.model));
        }
    }
    return errors;
}

}  // namespace nearpose::compare
