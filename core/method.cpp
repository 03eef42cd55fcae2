#include "core/method.hpp"

#include "core/base/check.hpp"

namespace nearpose {

Method method_paper() {
    Method method;
    method.start = Start::kSphere;
    method.start_candidates = 0;
    method.step.association = Association::kNearest;
    method.step.max_distance_diameters = 0.07;
    method.step.extra_sigma_diameters = 0.0;
    method.step.consensus_draws = 10;
    method.step.rounds = 3;
    method.step.max_rays = 64 * 48;
    method.cost = Cost::kOverlapMse;
    return method;
}

Method method_default() {
    Method method;
    method.start = Start::kPairs;
    method.start_candidates = 300;
    method.start_draws = 10000;
    method.step.max_rays = 400;
    method.start_step.rounds = 2;
    method.start_step.max_rays = 400;
    method.start_step.max_distance_diameters = 0.2;
    method.start_step.extra_sigma_diameters = 0.03;
    method.refinement.modes = 5;
    method.refinement.rivals = 96;
    method.economy.on = true;
    method.unmeasured_diffusion_diameters = 0.03;
    return method;
}

namespace {

void validate(const GradientStep& step, const std::string& name) {
    check_option(name + ".max_distance_diameters", step.max_distance_diameters, 1e-6, 10.0);
    check_option(name + ".extra_sigma_diameters", step.extra_sigma_diameters, 0.0, 10.0);
    check_option(name + ".max_normal_angle_rad", step.max_normal_angle_rad, 0.0, 3.15);
    check_option(name + ".consensus_draws", step.consensus_draws, 0, 100000);
    check_option(name + ".consensus_distance_diameters", step.consensus_distance_diameters, 1e-6, 10.0);
    check_option(name + ".rounds", step.rounds, 0, 100);
    check_option(name + ".step_size", step.step_size, 0.0, 1.0);
    check_option(name + ".max_rays", step.max_rays, 1, 1e7);
}

void validate(const Refinement& refinement) {
    check_option("refinement.modes", refinement.modes, 0, 1000);
    check_option("refinement.rounds", refinement.rounds, 1, 100);
    check_option("refinement.max_rays", refinement.max_rays, 1, 1e7);
    check_option("refinement.first_extra_sigma_diameters", refinement.first_extra_sigma_diameters, 0.0, 1.0);
    check_option("refinement.cost_sigma_diameters", refinement.cost_sigma_diameters, 0.0, 1.0);
    check_option("refinement.rays_per_evidence", refinement.rays_per_evidence, 1.0, 1e6);
    check_option("refinement.challenge_nats", refinement.challenge_nats, 0.0, 1e6);
    check_option("refinement.rivals", refinement.rivals, 0, 1e5);
    check_option("refinement.rival_period", refinement.rival_period, 1, 1e6);
    check_option("refinement.rival_modes", refinement.rival_modes, 0, 1000);
    check_option("refinement.shortlist", refinement.shortlist, 0, 1e5);
    check_option("refinement.min_support", refinement.min_support, 0.0, 1.0);
    check_option("refinement.frames_to_search", refinement.frames_to_search, 0, 1e6);
    check_option("refinement.frames_to_hold", refinement.frames_to_hold, 0, 1e6);
}

void validate(const Economy& economy) {
    check_option("economy.min_particles", economy.min_particles, 1, 1e6);
    check_option("economy.min_particles_unmeasured", economy.min_particles_unmeasured, 1, 1e6);
    check_option("economy.kld_error", economy.kld_error, 1e-6, 10.0);
    check_option("economy.step_rays", economy.step_rays, 1, 1e7);
    check_option("economy.step_rounds", economy.step_rounds, 0, 100);
    check_option("economy.rays", economy.rays, 1, 1e7);
    check_option("economy.fit_rays", economy.fit_rays, 1, 1e7);
    check_option("economy.rounds", economy.rounds, 1, 100);
    check_option("economy.confirming_rays", economy.confirming_rays, 1, 1e7);
    check_option("economy.confirming_rounds", economy.confirming_rounds, 1, 100);
    check_option("economy.rivals", economy.rivals, 0, 1e5);
}

}  // namespace

void validate(const Method& method) {
    check_option("start_candidates", method.start_candidates, 0, 1e6);
    check_option("start_draws", method.start_draws, 0, 1e7);
    validate(method.start_step, "start_step");
    validate(method.step, "step");
    validate(method.refinement);
    validate(method.economy);
    check_option("pixel_cost.truncation_sigmas", method.pixel_cost.truncation_sigmas, 0.1, 100.0);
    check_option("pixel_cost.deep_cost", method.pixel_cost.deep_cost, 1.0, 100.0);
    check_option("deep_diameters", method.deep_diameters, 0.0, 10.0);
    check_option("pixel_cost.occluded_cost", method.pixel_cost.occluded_cost, 0.0, 1.0);
    check_option("pixel_cost.unexplained_cost", method.pixel_cost.unexplained_cost, 0.0, 1.0);
    check_option("pixel_cost.outline_cost", method.pixel_cost.outline_cost, 0.0, 100.0);
    check_option("pixel_cost.independent_rays", method.pixel_cost.independent_rays, 0.0, 1e6);
    check_option("diffusion_rotation_rad", method.diffusion_rotation_rad, 0.0, 3.15);
    check_option("diffusion_diameters", method.diffusion_diameters, 0.0, 10.0);
    check_option("unmeasured_diffusion_diameters", method.unmeasured_diffusion_diameters, 0.0, 10.0);
    check_option("resample_below", method.resample_below, 0.0, 1.0);
}

}  // namespace nearpose
