#include "core/update/assess.hpp"

#include "core/base/parallel.hpp"
#include "core/fit/joint_fit.hpp"
#include "core/update/ray_grids.hpp"

namespace nearpose {
namespace {

// Covariances of the modes, in the twist about the object's origin. A mode that is alone was fitted.
void describe_modes(std::vector<Mode>& modes, const std::optional<Matrix6d>& covariance_if_alone,
                    const StepContext& context, const Frame& frame) {
    const int count = static_cast<int>(modes.size());
    const bool alone = count == 1 && covariance_if_alone;
    parallel_for(count, frame.options.num_threads, [&](int k) {
        modes[k].covariance = about_origin(
            alone ? *covariance_if_alone : covariance_at(modes[k].camera_from_object, context, frame.method().fit),
            frame.model.centre_in_object());
    });
}

}  // namespace

Assessment assess(UpdateResult& result, const Belief& belief, const std::optional<Matrix6d>& fit_covariance,
                  const Frame& frame, Ledger& ledger) {
    if (!belief.tracked) return {};
    constexpr double kOneMetre = 1.0;
    const bool estimated = result.status == UpdateStatus::kEstimated;
    const Eigen::Vector3d centre = frame.model.centre_in_object();
    const Pose& pose = belief.tracked->camera_from_object;
    const RefinementOptions refinement = plan_of(belief.lock.phase, frame.method(), false).refinement;
    const PixelGrid grid = ray_grid(frame, pose, refinement.max_rays);
    const StepContext context = frame.context(ledger.measured(grid, frame.observation), frame.method().step);

    result.camera_from_object = pose;
    result.cost = belief.tracked->cost;
    std::optional<Matrix6d> observed = fit_covariance;  // by this observation alone
    if (!belief.track) observed = covariance_at(pose, context, frame.method().fit);
    result.covariance = about_origin(belief.track ? belief.track->whole_covariance() : *observed, centre);
    if (!estimated) observed.reset();
    result.observability = observability_of(observed.value_or(kOneMetre * Matrix6d::Identity()),
                                            0.5 * frame.model.diameter_m(), frame.options.tolerance.translation_m);
    describe_modes(result.modes, observed, context, frame);

    Evidence evidence;
    evidence.seen = estimated;
    evidence.pixels = refined_cost(pose, context, refinement);
    evidence.alternatives_weight = belief.lock.alternatives_weight;
    evidence.alternatives_tried = belief.lock.alternatives_tried;
    evidence.covariance_about_centre = about_centre(result.covariance, centre);
    result.pixels = evidence.pixels;
    result.verdict = judge(evidence, frame.options.tolerance, frame.model.symmetries, frame.method().verification);

    const double nats = log_evidence_over_nothing(evidence.pixels, frame.method().pixel_cost,
                                                  frame.method().refinement.rays_per_evidence);
    return {result.verdict, is_verified(evidence, frame.method().verification),
            result.verdict == Verdict::kLost ? 0.0 : evidence.pixels.agreement(), nats * grid.stride * grid.stride};
}

}  // namespace nearpose
