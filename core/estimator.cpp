#include "core/estimator.hpp"

#include <stdexcept>
#include <utility>

#include "core/search/sampling.hpp"
#include "core/update/assess.hpp"
#include "core/update/choose.hpp"
#include "core/update/fuse.hpp"
#include "core/update/move_particles.hpp"
#include "core/update/predict.hpp"
#include "core/update/refine.hpp"
#include "core/update/repeated_image.hpp"
#include "core/update/search.hpp"
#include "core/update/situation.hpp"

namespace nearpose {
namespace {

// A transform that is not finite was not measured.
std::optional<Pose> measured(const std::optional<Pose>& now_from_before) {
    return now_from_before && is_valid(*now_from_before) ? now_from_before : std::nullopt;
}

Belief knowing_nothing(std::uint64_t step) {
    Belief belief;
    belief.step = step;
    return belief;
}

UpdateResult nothing_seen(const Observation& observation) {
    UpdateResult result;
    result.points_observed = observation.num_candidates();
    result.verdict = Verdict::kLost;
    result.missing = {{Requirement::kSeen, 0.0, 1.0, {}}};
    return result;
}

UpdateStatus status_of(bool seen, bool has_pose) {
    if (seen) return UpdateStatus::kEstimated;
    return has_pose ? UpdateStatus::kPredicted : UpdateStatus::kNoPose;
}

void write_choice(const Choice& choice, const MovedParticles& moved, UpdateResult& result) {
    result.effective_sample_size = moved.effective_sample_size;
    result.modes = choice.modes;
    if (!choice.seen) return;
    result.score = choice.score;
    result.mode_replaced = choice.replaces_tracked;
}

}  // namespace

PoseEstimator::PoseEstimator(std::shared_ptr<const ViewGenerator> views, std::shared_ptr<const PoseSolver> solver,
                             const EstimatorOptions& options)
    : solver_(std::move(solver)), options_(options), budget_(options.budget_s) {
    if (!solver_) throw std::invalid_argument("PoseEstimator: a pose solver is needed");
    validate(options_);
    model_ = std::make_shared<const ObjectModel>(make_object_model(std::move(views), options_));
}

UpdateResult PoseEstimator::update(const Observation& observation, const std::optional<Pose>& now_from_before) {
    const Method& method = options_.method;
    const Frame frame{*model_, *solver_, options_, observation, measured(now_from_before), belief_.step + 1};
    Ledger ledger(budget_);
    const ImageMemory image =
        seen_again(belief_.image, observation, frame.now_from_before, options_.method.repeated_image);
    if (image.repeats > 0) return take_prediction(image, frame);
    UpdateResult result = nothing_seen(observation);
    std::optional<JointFit> fit;
    bool seen = false;

    // The paper: resampling where the weights are uneven, control, diffusion.
    Belief belief = predict(belief_, frame, ledger);
    if (frame.shows_enough()) {
        // The default method: the phase says what the frame is worth, and a pose that is not known is searched for.
        Situation situation = situation_of(belief, method);
        belief.pose_before_loss = pose_before_loss(belief, situation.phase, method);
        SearchResult found{belief.particles, nullptr, {}};
        if (situation.searching()) found = search(situation.plan, frame, ledger);
        situation = gate_prediction(after_search(situation, found), belief, frame, ledger);
        belief.lock = after_decision(belief.lock, situation.phase);

        // The paper: view, correspondences, gradient steps and weight of every particle; the estimate is the MAP. The
        // default method compares the modes of the posterior with their alternatives.
        const MovedParticles moved = move_particles(found.particles, situation, frame, ledger);
        const bool modes_compared = method.hypotheses.modes > 0;
        const Choice choice =
            modes_compared ? choose_mode(belief, moved, situation, frame, ledger) : choose_map(moved, frame);
        seen = choice.seen;
        if (seen) adopt(belief, moved, choice);
        // The default method: a joint fit of pose and sensor errors, fused with the prediction.
        if (seen && modes_compared) fit = fuse(belief, choice, situation, frame, ledger);
        write_choice(choice, moved, result);
    }
    result.status = status_of(seen, belief.tracked.has_value());
    const Assessment assessment = assess(result, belief, fit, frame, ledger);
    belief.lock = after_assessment(belief.lock, assessment, method);

    // All state is written here: an update that throws leaves no trace.
    belief.image = image;
    budget_ = ledger.close(result);
    belief_ = std::move(belief);
    return result;
}

UpdateResult PoseEstimator::take_prediction(const ImageMemory& image, const Frame& frame) {
    Ledger ledger(budget_);
    Belief belief = predict(belief_, frame, ledger);
    belief.image = image;
    UpdateResult result = predicted_alone(belief, frame);
    budget_ = ledger.close(result);
    belief_ = std::move(belief);
    return result;
}

void PoseEstimator::restore(const Belief& belief) {
    if (belief.particles.poses.size() != belief.particles.negative_log_weights.size())
        throw std::invalid_argument("PoseEstimator: the belief to put back has particles without weights");
    if (belief.tracked.has_value() != (belief.particles.size() > 0))
        throw std::invalid_argument("PoseEstimator: the belief to put back has particles without a tracked pose");
    Belief copy = belief;
    belief_ = std::move(copy);  // cannot fail half way, as an assignment of the members one by one could
}

void PoseEstimator::reset() {
    belief_ = knowing_nothing(belief_.step);
}

void PoseEstimator::reset(const Pose& camera_from_object, const Diffusion& spread) {
    if (!is_valid(camera_from_object))
        throw std::invalid_argument("PoseEstimator: the pose to start from is not a finite rigid transform");
    Belief belief = knowing_nothing(belief_.step);
    belief.particles =
        sample_around(camera_from_object, spread, model_->extent(), options_.num_particles, options_.seed, belief.step);
    belief.tracked = mode_at(camera_from_object);
    belief_ = std::move(belief);
}

}  // namespace nearpose
