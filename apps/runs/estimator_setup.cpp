#include "apps/runs/estimator_setup.hpp"

#include <algorithm>
#include <stdexcept>

#include "core/base/check.hpp"
#include "optim/ceres_pose_solver.hpp"
#include "raycast/embree_view_generator.hpp"
#include "raycast/nested_spheres_generator.hpp"
#include "raycast/sphere_view_generator.hpp"

namespace nearpose::program {

const std::vector<std::string>& view_names() {
    static const std::vector<std::string> names = {"raycast",        "raster", "raster_cells",
                                                   "raster_as_rays", "sphere", "spheres"};
    return names;
}

bool is_rasteriser(const std::string& views) {
    return views == "raster" || views == "raster_cells" || views == "raster_as_rays";
}

RasterBuffer raster_buffer(const std::string& views) {
    if (views == "raster_cells") return RasterBuffer::kCells;
    return views == "raster_as_rays" ? RasterBuffer::kAsRays : RasterBuffer::kSplats;
}

const std::vector<std::string>& method_names() {
    static const std::vector<std::string> names = {"default", "paper"};
    return names;
}

const std::vector<std::string>& residual_names() {
    static const std::vector<std::string> names = {"point", "plane"};
    return names;
}

const std::vector<std::string>& parts_of_method() {
    static const std::vector<std::string> names = {
        "nothing", "fine_fit", "outline",  "depths", "pairs",         "shortlist", "rivals",        "confidence",
        "doubts",  "economy",  "presence", "memory", "shared_errors", "arm_check", "repeated_image"};
    return names;
}

std::shared_ptr<const ViewGenerator> make_view_generator(const EstimatorSetup& setup, const Mesh& mesh) {
    if (setup.view_samples && !is_rasteriser(setup.views)) {
        throw std::invalid_argument("samples of the surface belong to rasterised views, not " + setup.views);
    }
    if (setup.views == "raycast") return std::make_shared<EmbreeViewGenerator>(mesh);
    if (setup.views == "sphere") return std::make_shared<SphereViewGenerator>(mesh);
    if (setup.views == "spheres") return std::make_shared<NestedSpheresGenerator>(mesh, nested_spheres());
    if (!is_rasteriser(setup.views)) {
        throw std::invalid_argument("views '" + setup.views +
                                    "': take raycast, raster, raster_cells, raster_as_rays, sphere or spheres");
    }
    RasterOptions options;
    options.buffer = raster_buffer(setup.views);
    if (setup.view_samples) options.num_samples = *setup.view_samples;
    check_option("samples of the surface", options.num_samples, 1, 1e8);
    return std::make_shared<RasterViewGenerator>(mesh, options);
}

namespace {

void leave_out(const std::string& part, Method& method) {
    const auto& parts = parts_of_method();
    if (std::find(parts.begin(), parts.end(), part) == parts.end())
        throw std::invalid_argument("without '" + part +
                                    "': take nothing, fine_fit, outline, depths, pairs, shortlist, rivals, confidence, "
                                    "doubts, economy, presence, memory, shared_errors, arm_check or repeated_image");
    if (part != "nothing" && method.hypotheses.modes == 0)
        throw std::invalid_argument("without " + part + ": only the default method has it");
    if (part == "fine_fit") method.fusion = false;
    if (part == "outline") method.refinement.outline = false;
    if (part == "depths") method.free_space_depth_diameters = 0.0;
    if (part == "shortlist") method.preselection.tried = 0;
    if (part == "pairs") method.search.initialisation = Initialisation::kSurface;
    if (part == "rivals") method.hypotheses.alternatives = 0;
    if (part == "presence") {
        method.verification.min_log_odds_present = method.verification.lost_below_log_odds = -1e9;
        method.preselection.presence_rays = 0;
    }
    if (part == "memory") method.choice.log_odds_kept = method.choice.log_odds_kept_unmeasured = 0.0;
    if (part == "shared_errors") method.verification.shared_errors_allowed = 0.0;
    if (part == "arm_check") method.arm_check.on = false;
    if (part == "repeated_image") method.repeated_image.on = false;
    if (part == "confidence") method.choice.accepted_evidence = false;
    if (part == "doubts") method.relocalisation.low_agreement = false;
    if (part == "economy") method.effort.on = false;
}

}  // namespace

Method make_method(const EstimatorSetup& setup) {
    if (setup.method != "default" && setup.method != "paper") {
        throw std::invalid_argument("method '" + setup.method + "': take default or paper");
    }
    Method method = setup.method == "paper" ? method_paper() : method_default();
    if (!setup.adaptive) method.effort.min_particles = method.effort.min_particles_unmeasured = setup.particles;
    if (setup.rounds && setup.gradient) {
        check_option("rounds (of the gradient step)", *setup.rounds, 1, 100);
        method.step.rounds = *setup.rounds;
    }
    if (setup.consensus_draws) method.step.consensus_draws = *setup.consensus_draws;
    if (setup.overlap) {
        if (method.cost != Cost::kOverlapMse) throw std::invalid_argument("overlap belongs to the method paper");
        method.scale_by_overlap = *setup.overlap;
    }
    if (!setup.gradient) {
        if (setup.rounds.value_or(0) != 0 || setup.residual) {
            throw std::invalid_argument("rounds and residual are of the gradient step, which is off");
        }
        method.step.rounds = 0;
        method.search.step.rounds = 0;
        method.hypotheses.modes = 0;
    }
    leave_out(setup.without, method);
    validate(method);
    return method;
}

std::shared_ptr<const PoseSolver> make_solver(const EstimatorSetup& setup) {
    const bool paper = setup.method == "paper";
    const std::string residual = setup.residual.value_or(paper ? "point" : "plane");
    if (residual != "point" && residual != "plane") {
        throw std::invalid_argument("residual '" + residual + "': take point or plane");
    }
    CeresSolverOptions options;
    options.residual = residual == "point" ? ResidualKind::kPointToPoint : ResidualKind::kPointToPlane;
    if (paper) options.loss = RobustLoss::kNone;
    if (paper && residual == "point") options.min_pairs = 3;
    return std::make_shared<CeresPoseSolver>(options);
}

PoseEstimator make_estimator(const EstimatorSetup& setup, std::shared_ptr<const ViewGenerator> views) {
    EstimatorOptions options;
    options.method = make_method(setup);
    options.method.arm_check.sightings.max_count = setup.max_sightings;
    options.num_particles = setup.particles;
    options.budget_s = setup.budget_s;
    options.num_threads = setup.threads;
    options.seed = setup.seed;
    options.symmetries = setup.symmetries;
    options.tolerance = setup.tolerance;
    return PoseEstimator(std::move(views), make_solver(setup), options);
}

}  // namespace nearpose::program
