#include "apps/experiment/run_cells.hpp"

#include <algorithm>

#include "apps/base/thread_time.hpp"
#include "core/estimator.hpp"

namespace nearpose::experiment {
namespace {

// One estimator on its way through a recording.
struct Lane {
    std::string key;  // of the estimator's settings
    program::EstimatorSetup setup;
    bool starts_at_truth = false;  // before every frame
    PoseEstimator estimator;
    std::vector<evaluation::FrameErrors> frames;
    std::vector<double> cpu_s;
};

// What the estimators are given of one frame: made when it is first wanted.
class FrameInput {
  public:
    explicit FrameInput(const simulate::SimulatedFrame& frame) : frame_(frame) {}

    const Observation& observation(bool with_mask) {
        std::optional<Observation>& made = observations_[with_mask ? 1 : 0];
        if (!made) {
            const double begin = thread_cpu_s();
            made = make_observation(frame_.depth, frame_.camera,
                                    with_mask ? std::optional(frame_.given_mask) : std::nullopt);
            cpu_s_[with_mask ? 1 : 0] = thread_cpu_s() - begin;
        }
        return *made;
    }
    double cpu_s(bool with_mask) const { return cpu_s_[with_mask ? 1 : 0]; }

  private:
    const simulate::SimulatedFrame& frame_;
    std::optional<Observation> observations_[2];
    double cpu_s_[2] = {0.0, 0.0};  // that making them took
};

evaluation::TrueFrame truth_of(const simulate::SimulatedFrame& frame, const PinholeCamera& camera) {
    evaluation::TrueFrame truth{frame.id, frame.camera_from_object, {}};
    truth.after_fault = frame.after_fault;
    if (!frame.shows_part()) {
        truth.shown = frame.nonsense ? evaluation::Shown::kNonsense : evaluation::Shown::kNothing;
        return truth;
    }
    truth.visibility = evaluation::visibility_of(frame.depth, frame.visible, camera);
    if (truth.visibility && frame.truth.silhouette_pixels > 0) {
        truth.visibility->visible_fraction =
            static_cast<double>(frame.truth.visible_pixels) / frame.truth.silhouette_pixels;
    }
    return truth;
}

// A start that is right, but for about as much as a pose is off from one frame to the next.
constexpr Diffusion kSpreadAtTruth{0.0087266462599716477, 0.001};  // half a degree, 1 mm

void track(Lane& lane, FrameInput& input, const std::optional<Pose>& now_from_before,
           const evaluation::TrueFrame& truth, const evaluation::ModelShape& shape, const PinholeCamera& camera) {
    const Observation& observation = input.observation(lane.setup.use_mask);
    const double begin = thread_cpu_s();
    if (lane.starts_at_truth) lane.estimator.reset(truth.camera_from_object, kSpreadAtTruth);
    const bool moved = lane.setup.use_control && !lane.starts_at_truth;  // the true pose is of this frame already
    const UpdateResult result = lane.estimator.update(observation, moved ? now_from_before : std::nullopt);
    lane.cpu_s.push_back(thread_cpu_s() - begin + input.cpu_s(lane.setup.use_mask));
    std::optional<evaluation::EstimatedFrame> estimate;
    if (result.status != UpdateStatus::kNoPose) {
        estimate.emplace();
        estimate->camera_from_object = result.camera_from_object;
        estimate->score = result.score;
        estimate->time_s = -1.0;  // kept apart, so that the same run gives the same bytes
        estimate->predicted = result.status == UpdateStatus::kPredicted;
        estimate->covariance = result.covariance;
    }
    lane.frames.push_back(evaluation::frame_errors(truth, estimate, shape, camera));
    lane.frames.back().verdict = result.verdict;  // also where there is no pose
}

std::string estimator_key(const Settings& settings) {
    return json_of(used_for(TableKind::kRun, SettingUse::kEstimator, settings));
}

// One for each estimator that is among the settings.
std::vector<Lane> make_lanes(const std::vector<Settings>& settings, std::uint64_t seed, Workshop& workshop) {
    std::vector<Lane> lanes;
    for (const Settings& cell : settings) {
        const std::string key = estimator_key(cell);
        if (std::any_of(lanes.begin(), lanes.end(), [&](const Lane& lane) { return lane.key == key; })) continue;
        program::EstimatorSetup setup = estimator_setup(cell, seed);
        setup.symmetries = workshop.part(cell).symmetries;
        lanes.push_back(
            {key, setup, starts_at_truth(cell), program::make_estimator(setup, workshop.views(cell, seed)), {}, {}});
    }
    return lanes;
}

}  // namespace

CellResult run_result(std::vector<evaluation::FrameErrors> frames, const std::vector<double>& cpu_s,
                      double model_diameter_m, const evaluation::SummaryOptions& options) {
    CellResult result;
    result.figures = figures_of(evaluation::summarise(frames, model_diameter_m, options), options);
    if (!cpu_s.empty()) {
        const evaluation::Statistics cpu = evaluation::statistics_of(cpu_s);
        result.time = {{"cpu_ms", 1e3 * cpu.median}, {"cpu_ms_mean", 1e3 * cpu.mean}, {"cpu_ms_max", 1e3 * cpu.max}};
    }
    result.frames = std::move(frames);
    return result;
}

std::vector<CellResult> run_recording(const std::vector<Settings>& settings, std::uint64_t seed, Workshop& workshop,
                                      const std::function<bool()>& go_on) {
    const PartAssets& assets = workshop.part(settings.front());
    const simulate::Recording recording(assets.part.mesh, assets.part.part,
                                        recording_options(settings.front(), seed, workshop.folder()));
    const PinholeCamera& camera = recording.options().camera;
    std::vector<Lane> lanes = make_lanes(settings, seed, workshop);
    std::optional<Pose> camera_from_world_before;
    bool part_moved_before = false;
    for (int index = 0; index < recording.num_frames(); ++index) {
        if (!go_on()) return {};
        const simulate::SimulatedFrame frame = recording.frame(index);
        evaluation::TrueFrame truth = truth_of(frame, camera);
        truth.part_moved = frame.part_moved && !part_moved_before;
        part_moved_before = frame.part_moved;
        std::optional<Pose> now_from_before;
        if (camera_from_world_before) now_from_before = frame.camera_from_world * camera_from_world_before->inverse();
        camera_from_world_before = frame.camera_from_world;
        FrameInput input(frame);
        for (Lane& lane : lanes) track(lane, input, now_from_before, truth, assets.shape, camera);
    }
    std::vector<CellResult> results;
    for (const Settings& cell : settings) {
        const std::string key = estimator_key(cell);
        const auto lane = std::find_if(lanes.begin(), lanes.end(), [&](const Lane& other) { return other.key == key; });
        results.push_back(run_result(lane->frames, lane->cpu_s, assets.shape.info.diameter_m, summary_options(cell)));
    }
    return results;
}

CellResult run_views(const Settings& settings, std::uint64_t seed, Workshop& workshop) {
    CellResult result;
    for (const auto& [name, value] : workshop.view_bench(settings).numbers(view_cell(settings, seed))) {
        const bool of_time = name.find("cpu") != std::string::npos;
        (of_time ? result.time : result.figures)[name] = value;
    }
    return result;
}

}  // namespace nearpose::experiment
