#include "optim/ceres_pose_solver.hpp"

#include <ceres/problem.h>
#include <ceres/solver.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "optim/internal/registration_cost.hpp"
#include "optim/internal/se3_manifold.hpp"

namespace nearpose {
namespace {

[[noreturn]] void refuse(const std::string& field, double value, const std::string& bound) {
    throw std::invalid_argument("CeresSolverOptions." + field + " is " + std::to_string(value) + "; it must be " +
                                bound);
}

ceres::Solver::Options solver_options(const CeresSolverOptions& options, double damped_weight) {
    ceres::Solver::Options result;
    result.linear_solver_type =
        ceres::DENSE_NORMAL_CHOLESKY;  // 7 x 6: half the time of DENSE_QR, and J is a factor already
    result.max_num_iterations = options.max_iterations;
    result.function_tolerance = options.function_tolerance;
    result.gradient_tolerance = 0.0;  // has the unit of a squared weight: no bound holds for every sigma
    result.parameter_tolerance = 1e-12;
    result.num_threads = 1;
    result.logging_type = ceres::SILENT;
    result.minimizer_progress_to_stdout = false;
    result.jacobi_scaling = false;
    // The same damping for all directions. Ceres' usual one follows the diagonal of J^T J, and a plane that is tilted
    // by a hundredth would be reached by sliding along it a hundred times as far.
    result.min_lm_diagonal = damped_weight;
    result.max_lm_diagonal = damped_weight;
    result.initial_trust_region_radius = 1.0 / options.damping;
    result.max_trust_region_radius = result.initial_trust_region_radius;
    return result;
}

ceres::Problem::Options problem_options() {
    ceres::Problem::Options result;
    result.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    result.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    result.disable_all_safety_checks = true;
    return result;
}

}  // namespace

void validate(const CeresSolverOptions& options) {
    const int least_pairs = options.residual == ResidualKind::kPointToPoint ? 3 : 6;
    if (!(options.loss_scale_sigmas > 0.0) || !std::isfinite(options.loss_scale_sigmas)) {
        refuse("loss_scale_sigmas", options.loss_scale_sigmas, "positive and finite");
    }
    if (options.max_iterations < 1) refuse("max_iterations", options.max_iterations, "at least 1");
    if (options.min_pairs < least_pairs) {
        refuse("min_pairs", options.min_pairs, "at least " + std::to_string(least_pairs) + " for this residual");
    }
    if (!(options.function_tolerance >= 0.0 && options.function_tolerance < 1.0)) {
        refuse("function_tolerance", options.function_tolerance, "in [0, 1)");
    }
    if (!(options.damping >= 1e-10 && options.damping <= 1e6)) {
        refuse("damping", options.damping, "in [1e-10, 1e6]");
    }
}

CeresPoseSolver::CeresPoseSolver(const CeresSolverOptions& options) : options_(options) {
    validate(options_);
}

SolveResult CeresPoseSolver::solve(const Correspondences& pairs, const Pose& camera_from_object) const {
    SolveResult result{camera_from_object, 0.0, 0.0, SolveStatus::kNotUsable};
    if (pairs.size() < static_cast<std::size_t>(options_.min_pairs)) {
        result.status = SolveStatus::kTooFewPairs;
        return result;
    }
    const NormalisedPairs normalised(pairs, options_.residual);
    if (!normalised.usable || !is_valid(camera_from_object)) return result;

    RegistrationCost cost(normalised, options_.residual, options_.loss, options_.loss_scale_sigmas);
    Se3Manifold manifold;
    Se3Manifold::Ambient parameters = Se3Manifold::ambient_from_pose(normalised.normalised(camera_from_object));
    // Ceres prints, whatever its log is set to, where it cannot evaluate the start or factorise a step's matrix.
    const NormalEquations& at_start = cost.sums_at(parameters);
    if (!is_finite(at_start)) return result;
    const double damped_weight = std::max(normalised.total_squared_weight, at_start.jtj.trace());
    ceres::Problem problem(problem_options());
    problem.AddParameterBlock(parameters.data(), Se3Manifold::kAmbientSize, &manifold);
    problem.AddResidualBlock(&cost, nullptr, parameters.data());
    ceres::Solver::Summary summary;
    ceres::Solve(solver_options(options_, damped_weight), &problem, &summary);

    // Ceres' own verdict is not enough: it calls an infinite cost converged.
    const Pose found = normalised.metric(Se3Manifold::pose_from_ambient(parameters.data()));
    if (!summary.IsSolutionUsable() || !std::isfinite(summary.initial_cost)) return result;
    result.initial_cost = result.final_cost = summary.initial_cost;
    if (!(summary.final_cost <= summary.initial_cost) || !is_valid(found)) return result;
    result.camera_from_object = found;
    result.final_cost = summary.final_cost;
    result.status = SolveStatus::kConverged;
    return result;
}

}  // namespace nearpose
