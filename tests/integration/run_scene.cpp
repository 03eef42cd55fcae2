#include "tests/integration/run_scene.hpp"

#include <algorithm>
#include <limits>

#include "apps/data_set/bop_ground_truth.hpp"
#include "apps/data_set/bop_models.hpp"
#include "apps/data_set/bop_scene.hpp"
#include "apps/runs/estimator_setup.hpp"
#include "apps/runs/frame_source.hpp"
#include "core/estimator.hpp"
#include "raycast/mesh_loader.hpp"

namespace nearpose::test {

std::vector<evaluation::FrameErrors> run_scene(const std::filesystem::path& scene, const std::filesystem::path& models,
                                               const SceneRun& run) {
    constexpr int kObject = 1;
    const Mesh mesh = load_mesh(data_set::model_path(models, kObject), LengthUnit::kMillimetre).mesh;
    const data_set::ModelInfo info = data_set::read_model_info(models, kObject);
    const auto truth = data_set::read_ground_truth(scene, kObject);
    const auto source = program::open_bop_source(scene, {}, {run.with_masks, kObject, std::nullopt});
    program::EstimatorSetup setup;
    setup.method = run.method;
    setup.views = run.views;
    setup.particles = run.particles;
    setup.seed = run.seed;
    PoseEstimator estimator = program::make_estimator(setup, program::make_view_generator(setup, mesh));
    std::vector<evaluation::FrameErrors> errors;
    std::optional<Pose> camera_from_world_before;
    for (std::size_t k = 0; k < source->frames().size(); ++k) {
        const program::FrameInfo& frame = source->frames()[k];
        std::optional<Pose> now_from_before;
        if (frame.camera_from_world && camera_from_world_before)
            now_from_before = *frame.camera_from_world * camera_from_world_before->inverse();
        camera_from_world_before = frame.camera_from_world;
        const Observation observation = program::observe_frame(frame, source->load(k));
        const UpdateResult result = estimator.update(observation, now_from_before);
        evaluation::FrameErrors& error = errors.emplace_back();
        error.frame_id = frame.id;
        if (result.status != UpdateStatus::kNoPose && truth.count(frame.id) != 0)
            error.errors = evaluation::pose_error(result.camera_from_object, truth.at(frame.id), info);
    }
    return errors;
}

evaluation::PoseErrors worst_after(const std::vector<evaluation::FrameErrors>& frames, std::size_t first) {
    constexpr double kLost = std::numeric_limits<double>::infinity();
    evaluation::PoseErrors worst;
    for (std::size_t k = first; k < frames.size(); ++k) {
        worst.translation_m = std::max(worst.translation_m, frames[k].errors ? frames[k].errors->translation_m : kLost);
        worst.rotation_rad = std::max(worst.rotation_rad, frames[k].errors ? frames[k].errors->rotation_rad : kLost);
    }
    return worst;
}

}  // namespace nearpose::test
