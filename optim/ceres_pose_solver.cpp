#include "optim/ceres_pose_solver.hpp"

#include <ceres/tiny_solver.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "optim/internal/registration_cost.hpp"

namespace nearpose {
namespace {

[[noreturn]] void refuse(const std::string& field, double value, const std::string& bound) {
    throw std::invalid_argument("CeresSolverOptions." + field + " is " + std::to_string(value) + "; it must be " +
                                bound);
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

    RegistrationCost cost(normalised, {options_.residual, options_.loss, options_.loss_scale_sigmas},
                          normalised.normalised(camera_from_object));
    Twist parameters = Twist::Zero();
    const RegistrationEquations at_start = cost.sums_at(parameters);
    if (!is_finite(at_start)) return result;
    // The same damping for all directions. The usual one of Levenberg and Marquardt follows the diagonal of J^T J: a
    // plane tilted by a hundredth against an axis would then be reached by sliding along it, a hundred times as far.
    cost.set_stay(options_.damping * std::max(normalised.total_squared_weight, at_start.jtj.trace()));
    ceres::TinySolver<RegistrationCost> solver;
    solver.options.initial_trust_region_radius = 1e8;
    solver.options.max_num_iterations = options_.max_iterations + 1;  // its count begins before the first step
    solver.options.function_tolerance = options_.function_tolerance * at_start.rtr;  // its own is absolute
    solver.options.gradient_tolerance = 0.0;  // has the unit of a squared weight: no bound holds for every sigma
    solver.options.cost_threshold = 0.0;
    solver.options.parameter_tolerance = 1e-12;
    solver.Solve(cost, &parameters);

    const Pose found = normalised.metric(cost.pose_at(parameters.data()));
    const RegistrationEquations& at_end = cost.sums_at(parameters);
    result.initial_cost = result.final_cost = 0.5 * at_start.rtr;
    if (!is_finite(at_end) || !(at_end.rtr <= at_start.rtr) || !is_valid(found)) return result;
    result.camera_from_object = found;
    result.final_cost = 0.5 * at_end.rtr;
    result.status = SolveStatus::kConverged;
    return result;
}

}  // namespace nearpose
