#include "core/filter/gradient_step.hpp"

#include <chrono>

#include "core/base/check.hpp"
#include "core/filter/association.hpp"

namespace nearpose {
namespace {

class Timer {
  public:
    explicit Timer(double& seconds) : seconds_(seconds), start_(Clock::now()) {}
    ~Timer() { seconds_ += std::chrono::duration<double>(Clock::now() - start_).count(); }
    Timer(const Timer&) = delete;
    Timer& operator=(const Timer&) = delete;

  private:
    using Clock = std::chrono::steady_clock;
    double& seconds_;
    Clock::time_point start_;
};

// A pose on its way, and what was spent on it so far.
struct Progress {
    Pose camera_from_object;
    StepCounts counts;
    StageSeconds seconds;
};

View cast(const StepContext& context, Progress& at) {
    const Timer timer(at.seconds.views);
    View view = context.views.generate(at.camera_from_object, context.observed.camera);
    at.counts.view_points += static_cast<long>(view.size());
    return view;
}

Correspondences find_pairs(const View& view, const StepContext& context, RandomStream random, Progress& at) {
    const Timer timer(at.seconds.association);
    const GradientStep& step = context.step;
    const Pose& pose = at.camera_from_object;
    const double diameter_m = context.views.extent().diameter_m();
    const double gate_m = step.max_distance_diameters * diameter_m;
    Correspondences pairs =
        step.association == Association::kNearest
            ? associate_nearest(view, pose, context.observation, gate_m)
            : associate_projective(view, pose, context.observation, gate_m, step.extra_sigma_diameters * diameter_m);
    at.counts.pairs += static_cast<long>(pairs.size());
    if (step.max_normal_angle_rad > 0.0) {
        const std::size_t before = pairs.size();
        pairs = reject_by_normal(pairs, pose, step.max_normal_angle_rad);
        at.counts.rejected_by_normal += static_cast<long>(before - pairs.size());
    }
    if (step.consensus_draws > 0) {
        const std::size_t before = pairs.size();
        pairs = reject_by_sample_consensus(
            pairs, {step.consensus_draws, step.consensus_distance_diameters * diameter_m}, random);
        at.counts.rejected_by_consensus += static_cast<long>(before - pairs.size());
    }
    return pairs;
}

void solve(const Correspondences& pairs, const StepContext& context, Progress& at) {
    const Timer timer(at.seconds.solving);
    const SolveResult solved = context.solver.solve(pairs, at.camera_from_object);
    ++at.counts.solves;
    at.counts.solves_with_too_few_pairs += solved.status == SolveStatus::kTooFewPairs;
    at.counts.solves_not_usable += solved.status == SolveStatus::kNotUsable;
    if (solved.status != SolveStatus::kConverged || !is_valid(solved.camera_from_object)) return;
    at.camera_from_object = context.step.step_size == 1.0
                                ? solved.camera_from_object
                                : interpolate(at.camera_from_object, solved.camera_from_object, context.step.step_size);
}

MovedParticle weighed_by_pixels(const StepContext& context, Progress& at) {
    const View view = cast(context, at);
    const Timer timer(at.seconds.likelihood);
    const PixelCost cost = pixel_cost(view, at.camera_from_object, context.observed, context.pixel_cost);
    MovedParticle moved;
    moved.cost = cost.cost;
    moved.support = cost.support();
    moved.gain = cost.gain;
    moved.negative_log_likelihood = negative_log_likelihood(cost, context.pixel_cost);
    return moved;
}

MovedParticle weighed_by_overlap(const Correspondences& pairs, std::size_t num_view_points, const StepContext& context,
                                 Progress& at) {
    const Timer timer(at.seconds.likelihood);
    const double gate_m = context.step.max_distance_diameters * context.views.extent().diameter_m();
    const double sensor_m = context.observation.sensor().sigma_m(context.observation.mean_distance_m());
    // As if the pairs were the whole view, m / n is 1.
    const std::size_t m = context.scale_by_overlap ? num_view_points : pairs.size();
    MovedParticle moved;
    moved.cost = overlap_scaled_mse(pairs, at.camera_from_object, m, gate_m);
    moved.negative_log_likelihood = negative_log_likelihood(moved.cost, sensor_m, gate_m);
    return moved;
}

}  // namespace

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

void validate(const RefinementOptions& options, const std::string& name) {
    check_option(name + ".rounds", options.rounds, 1, 100);
    check_option(name + ".rounds_per_view", options.rounds_per_view, 1, 100);
    check_option(name + ".max_rays", options.max_rays, 1, 1e7);
    check_option(name + ".first_extra_sigma_diameters", options.first_extra_sigma_diameters, 0.0, 1.0);
    check_option(name + ".extra_sigma_decay", options.extra_sigma_decay, 0.0, 1.0);
    check_option(name + ".gate_sigmas", options.gate_sigmas, 0.1, 1e3);
    check_option(name + ".cost_sigma_diameters", options.cost_sigma_diameters, 0.0, 1.0);
    check_option(name + ".rays_per_evidence", options.rays_per_evidence, 1.0, 1e6);
}

StageSeconds& StageSeconds::operator+=(const StageSeconds& other) {
    views += other.views;
    association += other.association;
    solving += other.solving;
    likelihood += other.likelihood;
    return *this;
}

StepCounts& StepCounts::operator+=(const StepCounts& other) {
    view_points += other.view_points;
    pairs += other.pairs;
    rejected_by_normal += other.rejected_by_normal;
    rejected_by_consensus += other.rejected_by_consensus;
    solves += other.solves;
    solves_with_too_few_pairs += other.solves_with_too_few_pairs;
    solves_not_usable += other.solves_not_usable;
    return *this;
}

MovedParticle move_particle(const Pose& camera_from_object, const StepContext& context, const RandomStream& random) {
    Progress at{camera_from_object, {}, {}};
    const View view = cast(context, at);
    Correspondences pairs;
    for (int round = 0; round < context.step.rounds; ++round) {
        pairs = find_pairs(view, context, random, at);
        solve(pairs, context, at);
    }
    // Without a step there are no pairs yet, and the overlap cost is of pairs.
    if (context.step.rounds == 0 && context.cost == Cost::kOverlapMse) pairs = find_pairs(view, context, random, at);
    MovedParticle moved = context.cost == Cost::kPixels ? weighed_by_pixels(context, at)
                                                        : weighed_by_overlap(pairs, view.size(), context, at);
    moved.camera_from_object = at.camera_from_object;
    moved.counts = at.counts;
    moved.seconds = at.seconds;
    return moved;
}

RefinedMode refine_mode(const Pose& camera_from_object, const StepContext& context, const RefinementOptions& options) {
    Progress at{camera_from_object, {}, {}};
    StepContext sharper = context;
    GradientStep& step = sharper.step;
    step.association = Association::kProjective;
    step.extra_sigma_diameters = options.first_extra_sigma_diameters;
    const double diameter_m = context.views.extent().diameter_m();
    const double sensor_m = context.observation.sigma_m(context.observation.mean_distance_m());
    const RandomStream unused(0, 0, 0, RandomPurpose::kSampleConsensus);
    View view;
    for (int round = 0; round < options.rounds; ++round) {
        step.max_distance_diameters = options.gate_sigmas * (step.extra_sigma_diameters + sensor_m / diameter_m);
        if (round % options.rounds_per_view == 0) view = cast(sharper, at);
        solve(find_pairs(view, sharper, unused, at), sharper, at);
        step.extra_sigma_diameters *= options.extra_sigma_decay;
    }
    RefinedMode refined;
    {
        const Timer timer(at.seconds.likelihood);
        const PixelCost cost = refined_cost(at.camera_from_object, context, options);
        refined.cost = cost.cost;
        refined.support = cost.support();
        refined.gain = cost.gain;
        refined.inlier_ratio = cost.inlier_ratio();
        refined.log_evidence = log_evidence(cost, context.pixel_cost, options.rays_per_evidence);
    }
    refined.camera_from_object = at.camera_from_object;
    refined.counts = at.counts;
    refined.seconds = at.seconds;
    return refined;
}

PixelCostOptions refined_cost_options(const StepContext& context, const RefinementOptions& options) {
    PixelCostOptions pixel_cost = context.pixel_cost;
    pixel_cost.extra_sigma_m = options.cost_sigma_diameters * context.views.extent().diameter_m();
    pixel_cost.outline_sigma_m = pixel_cost.extra_sigma_m;
    pixel_cost.with_outline = options.outline;
    return pixel_cost;
}

PixelCost refined_cost(const Pose& camera_from_object, const StepContext& context, const RefinementOptions& options) {
    const View view = context.views.generate(camera_from_object, context.observed.camera);
    return nearpose::pixel_cost(view, camera_from_object, context.observed, refined_cost_options(context, options));
}

}  // namespace nearpose
