#include "core/update/assess.hpp"

#include <algorithm>

#include "core/base/parallel.hpp"
#include "core/base/text.hpp"
#include "core/fit/joint_fit.hpp"
#include "core/update/pose_evidence.hpp"
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

// The likeliest alternative to a pose, in words; empty where no mode is one.
std::string name_of_alternative(const std::vector<Mode>& modes, const Pose& pose, const ObjectModel& model) {
    const Mode* likeliest = nullptr;
    for (const Mode& mode : modes)
        if (!model.same_mode(mode.camera_from_object, pose) && (!likeliest || mode.weight > likeliest->weight))
            likeliest = &mode;
    if (!likeliest) return {};
    const Pose change = pose.inverse() * likeliest->camera_from_object;  // in object axes
    const Eigen::AngleAxisd turn(change.rotation);
    const double shift_m = (change * model.centre_in_object() - model.centre_in_object()).norm();
    constexpr double kMillimetres = 1e3, kDegrees = 57.295779513082321;
    return "turned by " + fixed_text(kDegrees * turn.angle(), 0) + " degrees about " + axis_name(turn.axis()) +
           " and shifted by " + fixed_text(kMillimetres * shift_m, 1) + " mm";
}

void add_findings(const ArmFindings& arm, Evidence& evidence) {
    evidence.frames_since_move = arm.frames_since_move;
    evidence.motion_off_share = arm.motion.mistake == MotionMistake::kNone ? 0.0 : arm.motion.off_share;
    evidence.motion_mistake = to_string(arm.motion.mistake);
    evidence.setup_error_m = arm.world.error_bound_m;
    evidence.setup_cause = to_string(arm.world.cause);
}

}  // namespace

Assessment assess(UpdateResult& result, const Belief& belief, const std::optional<JointFit>& fit, const Frame& frame,
                  Ledger& ledger) {
    if (!belief.tracked) return {};
    constexpr double kOneMetre = 1.0;
    const Method& method = frame.method();
    const bool estimated = result.status == UpdateStatus::kEstimated;
    const Eigen::Vector3d centre = frame.model.centre_in_object();
    const Pose& pose = belief.tracked->camera_from_object;
    const RefinementOptions refinement = plan_of(belief.lock.phase, method, false).refinement;
    const PixelGrid grid = ray_grid(frame, pose, refinement.max_rays);
    const StepContext context = frame.context(ledger.measured(grid, frame.observation), method.step);

    result.camera_from_object = pose;
    result.cost = belief.tracked->cost;
    std::optional<Matrix6d> observed;  // by this observation alone
    if (fit) observed = fit->covariance + fit->constant_covariance;
    if (!belief.track) observed = covariance_at(pose, context, method.fit);
    result.covariance = about_origin(belief.track ? belief.track->whole_covariance() : *observed, centre);
    if (!estimated) observed.reset();
    result.observability =
        observability_of(observed.value_or(kOneMetre * Matrix6d::Identity()), 0.5 * frame.model.diameter_m(),
                         frame.options.tolerance.translation_m, frame.model.symmetries, centre);
    describe_modes(result.modes, observed, context, frame);
    const PoseEvidence shown = evidence_at(pose, context, refinement, frame,
                                           fit ? method.verification.shared_errors_allowed * fit->shared_sigma_m : 0.0);
    result.pixels = shown.judged;
    result.positive_evidence = shown.positive;
    result.log_odds_present = log_odds_with(shown.log_odds_present, belief.lock, method.presence);

    Evidence evidence;
    evidence.seen = estimated;
    evidence.log_odds_present = result.log_odds_present;
    evidence.pixels = result.pixels;
    evidence.alternatives_weight = belief.lock.alternatives_weight;
    evidence.alternatives_tried = belief.lock.alternatives_tried >= std::max(1, method.hypotheses.alternatives);
    evidence.alternative = name_of_alternative(result.modes, pose, frame.model);
    result.arm = check_arm(belief.sightings, centre, 0.5 * frame.model.diameter_m(), method.arm_check);
    add_findings(result.arm, evidence);
    evidence.covariance_about_centre = about_centre(result.covariance, centre);
    const Judgement judgement = judge(evidence, frame.options.tolerance, frame.model.symmetries, method.verification);
    result.verdict = judgement.verdict;
    result.missing = judgement.missing;

    const double nats = log_evidence_over_nothing(shown.pixels, method.pixel_cost, method.refinement.rays_per_evidence);
    return {judgement.verdict, judgement.verified,
            judgement.verdict == Verdict::kLost ? 0.0 : result.pixels.agreement(), nats * grid.stride * grid.stride,
            result.log_odds_present};
}

}  // namespace nearpose
