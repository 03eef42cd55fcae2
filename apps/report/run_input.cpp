#include "apps/report/run_input.hpp"

#include "apps/data_set/bop_ground_truth.hpp"
#include "apps/data_set/result_csv.hpp"
#include "apps/part_model/checked_model.hpp"
#include "apps/set_up/corrected_source.hpp"
#include "apps/set_up/setup_file.hpp"

namespace nearpose::report {
namespace {

constexpr std::size_t kMaxParticles = 1000;  // more than an eye can tell apart

using program::EstimateOptions;

void require(const std::filesystem::path& path, const std::string& what, const std::string& remedy) {
    if (path.empty() || std::filesystem::exists(path)) return;
    throw std::runtime_error(path.string() + ": " + what + " of the run is not there (any more); " + remedy);
}

void find_inputs(EstimateOptions& estimate, const RunReportOptions& options) {
    if (!options.scene.empty()) (estimate.clouds.empty() ? estimate.scene : estimate.clouds) = options.scene;
    if (!options.models.empty())
        (estimate.model.model.empty() ? estimate.model.models : estimate.model.model) = options.models;
    require(estimate.scene, "the scene", "say where it is with --scene DIR");
    require(estimate.clouds, "the folder of clouds", "say where it is with --scene DIR");
    require(estimate.camera, "the camera", "put it back");
    require(estimate.set_up, "the file of the set-up", "put it back");
    require(estimate.model.models, "the folder of models", "say where it is with --models DIR");
    require(estimate.model.model, "the model", "say where it is with --models FILE");
}

// The place of each logged frame among the scene's.
std::vector<std::size_t> match_frames(const RunInput& input, const std::filesystem::path& log) {
    std::map<int, std::size_t> place;
    for (std::size_t i = 0; i < input.source->frames().size(); ++i) place[input.source->frames()[i].id] = i;
    std::vector<std::size_t> matched;
    for (const LoggedFrame& frame : input.log) {
        const auto found = place.find(frame.frame_id);
        if (found == place.end()) {
            const EstimateOptions& estimate = input.record.options;
            throw std::runtime_error(
                log.string() + ": has frame " + std::to_string(frame.frame_id) + ", but " +
                (estimate.scene.empty() ? estimate.clouds : estimate.scene).string() +
                " has no such frame: it is not the scene of this run; say which is with --scene DIR");
        }
        matched.push_back(found->second);
    }
    return matched;
}

// The result file beside run.json must be of the same run.
void check_poses(const std::filesystem::path& poses_csv, const program::RunRecord& record) {
    if (!std::filesystem::exists(poses_csv)) return;
    for (const data_set::PoseRow& row : data_set::read_pose_csv(poses_csv)) {
        if (row.scene_id == record.scene_id && row.object_id == record.options.model.object) continue;
        throw std::runtime_error(poses_csv.string() + ": has poses of object " + std::to_string(row.object_id) +
                                 " in scene " + std::to_string(row.scene_id) + ", but " + program::kRunFile +
                                 " is of object " + std::to_string(record.options.model.object) + " in scene " +
                                 std::to_string(record.scene_id));
    }
}

void read_truth(RunInput& input, const std::function<void(const std::string&)>& notice) {
    const std::filesystem::path& scene = input.record.options.scene;
    if (scene.empty() || !std::filesystem::exists(scene / "scene_gt.json")) {
        notice("the true poses are not known (no scene_gt.json): the report shows no errors");
        return;
    }
    input.truth =
        data_set::read_ground_truth(scene, input.record.options.model.object, input.record.options.mask_index);
}

}  // namespace

RunInput read_run(const std::filesystem::path& folder, const RunReportOptions& options,
                  const std::function<void(const std::string&)>& notice) {
    RunInput input;
    input.record = program::read_run_record(folder);
    EstimateOptions& estimate = input.record.options;
    check_poses(folder / program::kPosesFile, input.record);
    const std::filesystem::path own_log = folder / program::kLogFile;
    const std::filesystem::path log = std::filesystem::exists(own_log) ? own_log : estimate.outputs.log;
    input.log = read_run_log(log);
    if (const auto particles = folder / program::kParticlesFile; std::filesystem::exists(particles)) {
        input.particles = read_particles(particles, kMaxParticles);
    } else {
        notice(particles.string() + " is not there: the report shows no particles");
    }
    find_inputs(estimate, options);
    if (!estimate.scene_id) estimate.scene_id = input.record.scene_id;  // whatever its folder is called now
    input.source = open_source(estimate);
    // The poses are of the corrected recording, and so is what they are drawn over.
    if (!estimate.set_up.empty())
        input.source = program::corrected_source(std::move(input.source), program::read_setup_file(estimate.set_up));
    input.frame_in_source = match_frames(input, log);
    input.mesh =
        program::load_checked_model(model_file(estimate.model), model_unit(estimate.model), estimate.model.keep_largest)
            .mesh;
    if (const auto& models = estimate.model.models;
        !models.empty() && std::filesystem::exists(models / "models_info.json")) {
        input.model_info = data_set::read_model_info(models, estimate.model.object);
    }
    read_truth(input, notice);
    return input;
}

}  // namespace nearpose::report
