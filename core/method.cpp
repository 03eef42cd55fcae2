#include "core/method.hpp"

#include <string>

#include "core/base/check.hpp"

namespace nearpose {

Method method_paper() {
    Method method;
    method.search.initialisation = Initialisation::kSphere;
    method.search.candidates = 0;
    method.step.association = Association::kNearest;
    method.step.max_distance_diameters = 0.07;
    method.step.extra_sigma_diameters = 0.0;
    method.step.consensus_draws = 10;
    method.step.rounds = 3;
    method.step.max_rays = 64 * 48;
    method.cost = Cost::kOverlapMse;
    method.repeated_image.on = false;
    return method;
}

Method method_default() {
    Method method;
    method.search.initialisation = Initialisation::kPairs;
    method.search.candidates = 300;
    method.search.draws = 10000;
    method.search.step.rounds = 2;
    method.search.step.max_rays = 400;
    method.search.step.max_distance_diameters = 0.2;
    method.search.step.extra_sigma_diameters = 0.03;
    method.step.max_rays = 400;
    method.hypotheses.modes = 5;
    method.hypotheses.alternatives = 96;
    method.effort.on = true;
    method.filter.unmeasured_diffusion_diameters = 0.03;
    return method;
}

namespace {

void validate(const FilterOptions& options) {
    check_option("filter.diffusion_rotation_rad", options.diffusion_rotation_rad, 0.0, 3.15);
    check_option("filter.diffusion_diameters", options.diffusion_diameters, 0.0, 10.0);
    check_option("filter.unmeasured_diffusion_diameters", options.unmeasured_diffusion_diameters, 0.0, 10.0);
    check_option("filter.resample_below", options.resample_below, 0.0, 1.0);
}

void validate(const PixelCostOptions& options) {
    check_option("pixel_cost.deep_sigmas", options.deep_sigmas, 0.0, 1e3);
    check_option("pixel_cost.truncation_sigmas", options.truncation_sigmas, 0.1, 100.0);
    check_option("pixel_cost.free_space_cost", options.free_space_cost, 1.0, 100.0);
    check_option("pixel_cost.occluded_cost", options.occluded_cost, 0.0, 1.0);
    check_option("pixel_cost.unexplained_cost", options.unexplained_cost, 0.0, 1.0);
    check_option("pixel_cost.outline_cost", options.outline_cost, 0.0, 100.0);
    check_option("pixel_cost.outline_gate_sigmas", options.outline_gate_sigmas, 0.0, 100.0);
    check_option("pixel_cost.outline_steps", options.outline_steps, 1, 100);
    check_option("pixel_cost.independent_rays", options.independent_rays, 0.0, 1e6);
}

void validate(const HypothesisOptions& options) {
    check_option("hypotheses.modes", options.modes, 0, 1000);
    check_option("hypotheses.alternatives", options.alternatives, 0, 1e5);
    check_option("hypotheses.alternatives_period", options.alternatives_period, 1, 1e6);
    check_option("hypotheses.alternatives_refined", options.alternatives_refined, 0, 1000);
    check_option("hypotheses.leaders", options.leaders, 1, 1000);
    check_option("hypotheses.changes.steps_per_turn", options.changes.steps_per_turn, 2, 360);
    check_option("hypotheses.changes.max_shift", options.changes.max_shift, 0.0, 10.0);
    check_option("hypotheses.mode_rotation_rad", options.mode_rotation_rad, 0.0, 3.15);
    check_option("hypotheses.mode_translation_diameters", options.mode_translation_diameters, 0.0, 10.0);
}

void validate(const PreselectionOptions& options) {
    check_option("preselection.tried", options.tried, 0, 1e5);
    check_option("preselection.rays", options.rays, 1, 1e7);
    check_option("preselection.rounds", options.rounds, 0, 100);
    check_option("preselection.kept", options.kept, 1, 1e5);
    check_option("preselection.presence_rays", options.presence_rays, 0, 1e7);
    check_option("preselection.disambiguated", options.disambiguated, 0, 1000);
}

void validate(const ChoiceOptions& options) {
    check_option("choice.challenge_nats", options.challenge_nats, 0.0, 1e6);
    check_option("choice.min_support", options.min_support, 0.0, 1.0);
    check_option("choice.accepted_evidence_kept", options.accepted_evidence_kept, 0.0, 1.0);
    check_option("choice.log_odds_kept", options.log_odds_kept, 0.0, 1.0);
    check_option("choice.log_odds_kept_unmeasured", options.log_odds_kept_unmeasured, 0.0, 1.0);
    check_option("choice.alternatives_remembered", options.alternatives_remembered, 0, 1000);
    check_option("choice.least_log_odds", options.least_log_odds, -1e6, 0.0);
    check_option("choice.alternatives_within_diameters", options.alternatives_within_diameters, 0.0, 1e3);
}

void validate(const PresenceOptions& options) {
    check_option("presence.kept", options.kept, 0.0, 1.0);
    check_option("presence.kept_unmeasured", options.kept_unmeasured, 0.0, 1.0);
    check_option("presence.max_log_odds", options.max_log_odds, 0.0, 1e6);
}

void validate(const RelocalisationOptions& options) {
    check_option("relocalisation.frames_contradicted", options.frames_contradicted, 0, 1e6);
    check_option("relocalisation.low_agreement_at_first", options.low_agreement_at_first, 0, 1e6);
    check_option("relocalisation.low_agreement_period", options.low_agreement_period, 1, 1e6);
    check_option("relocalisation.whole_searches", options.whole_searches, 0, 1e6);
    check_option("relocalisation.parts_of_search", options.parts_of_search, 1, 1000);
}

void validate(const PhaseEffort& effort, const std::string& name) {
    check_option(name + ".particle_rays", effort.particle_rays, 1, 1e7);
    check_option(name + ".mode_rays", effort.mode_rays, 1, 1e7);
    check_option(name + ".mode_rounds", effort.mode_rounds, 1, 100);
    check_option(name + ".alternatives", effort.alternatives, 0, 1e5);
}

void validate(const AdaptiveEffort& effort) {
    check_option("effort.frames_to_confirm", effort.frames_to_confirm, 0, 1e6);
    validate(effort.comparing, "effort.comparing");
    validate(effort.confirming, "effort.confirming");
    validate(effort.tracking, "effort.tracking");
    check_option("effort.predicted_rounds", effort.predicted_rounds, 0, 100);
    check_option("effort.fit_rays", effort.fit_rays, 1, 1e7);
    check_option("effort.min_particles", effort.min_particles, 1, 1e6);
    check_option("effort.min_particles_unmeasured", effort.min_particles_unmeasured, 1, 1e6);
    check_option("effort.kld_error", effort.kld_error, 1e-6, 10.0);
    check_option("effort.far_less_likely_nats", effort.far_less_likely_nats, 0.0, 1e6);
}

}  // namespace

void validate(const Method& method) {
    validate(method.search);
    validate(method.filter);
    check_option("window_margin", method.window_margin, 0.0, 10.0);
    validate(method.step, "step");
    validate(method.pixel_cost);
    check_option("free_space_depth_diameters", method.free_space_depth_diameters, 0.0, 10.0);
    validate(method.hypotheses);
    validate(method.preselection);
    validate(method.refinement, "refinement");
    validate(method.choice);
    validate(method.fit);
    validate(method.track);
    validate(method.background);
    validate(method.presence);
    validate(method.repeated_image);
    validate(method.arm_check);
    validate(method.verification);
    validate(method.relocalisation);
    validate(method.effort);
}

}  // namespace nearpose
