#include "apps/runs/estimator_start.hpp"

#include <map>
#include <numbers>
#include <string>
#include <utility>

#include "apps/base/console.hpp"
#include "apps/data_set/bop_models.hpp"
#include "apps/data_set/pose_file.hpp"
#include "apps/part_model/model_symmetries.hpp"

namespace nearpose::program {
namespace {

std::optional<data_set::ModelInfo> declared_info(const ModelOptions& model) {
    const std::filesystem::path file = model.models / "models_info.json";
    if (model.models.empty() || !std::filesystem::exists(file)) return std::nullopt;
    const std::map<int, data_set::ModelInfo> models = data_set::read_models_info(file);
    const auto found = models.find(model.object);
    return found == models.end() ? std::nullopt : std::optional(found->second);
}

// The declared ones, and what the part may be mistaken for besides, which BOP's files do not hold.
Symmetries with_near(const Symmetries& declared, const Symmetries& found) {
    Symmetries symmetries = declared;
    for (const Pose& turn : found.near_symmetries)
        if (!contains(declared, turn)) symmetries.near_symmetries.push_back(turn);
    return symmetries;
}

// The user is told which, where there are any.
Symmetries choose_symmetries(const EstimateOptions& options, const Mesh& mesh, const SharedOptions& shared) {
    if (options.symmetries == "none") return {};
    const std::optional<data_set::ModelInfo> info = declared_info(options.model);
    const Symmetries declared = info ? declared_symmetries(*info) : Symmetries{};
    const bool take_declared = options.symmetries == "declared" || !declared.empty();
    const Symmetries found = options.symmetries == "declared" ? Symmetries{} : find_symmetries(mesh);
    const Symmetries symmetries = take_declared ? with_near(declared, found) : found;
    if (!symmetries.empty() || !symmetries.near_symmetries.empty()) {
        const std::string source = take_declared ? "of models_info.json" : "found from the mesh";
        print_notice("symmetries " + source + ": " + describe(symmetries), shared.quiet);
    }
    return symmetries;
}

}  // namespace

Tolerance tolerance_of(const EstimateOptions& options) {
    return {1e-3 * options.tolerance_mm, options.tolerance_deg * std::numbers::pi / 180.0};
}

EstimatorSetup setup_of(const EstimateOptions& options, const Mesh& mesh, const SharedOptions& shared) {
    EstimatorSetup setup;
    setup.method = options.method;
    setup.views = options.views;
    setup.particles = options.particles.value_or(setup.particles);
    setup.adaptive = !options.particles;
    setup.budget_s = 1e-3 * options.budget_ms;
    setup.threads = options.threads;
    setup.seed = options.seed;
    setup.symmetries = choose_symmetries(options, mesh, shared);
    setup.tolerance = tolerance_of(options);
    return setup;
}

PoseEstimator start_estimator(const EstimatorSetup& setup, std::shared_ptr<const ViewGenerator> views,
                              const EstimateOptions& options) {
    PoseEstimator made = make_estimator(setup, std::move(views));
    if (!options.initial_pose.empty()) {
        made.reset(read_pose_file(options.initial_pose),
                   {options.initial_sigma_deg * std::numbers::pi / 180.0, 1e-3 * options.initial_sigma_mm});
    }
    return made;
}

}  // namespace nearpose::program
