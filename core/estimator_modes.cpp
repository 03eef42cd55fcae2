// Part of PoseEstimator: which modes there are, and which of them is the estimate.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>

#include "core/estimator.hpp"
#include "core/parallel.hpp"

namespace nearpose {
namespace {

Refinement unmoved(Refinement refinement) {
    refinement.rounds = 0;
    return refinement;
}

Mode mode_of(const MovedParticle& refined) {
    return {refined.camera_from_object, refined.cost, refined.support, refined.log_evidence};
}

// Noise is averaged over rays: so many more of them as it is larger, at the distance of what is seen, than the sensor's
// at contact.
int fit_rays(const Method& method, const Observation& observation) {
    const double noise = observation.sigma_m(observation.mean_distance_m()) / observation.sensor().sigma_floor_m;
    return static_cast<int>(
        std::min<double>(method.refinement.max_rays, method.economy.fit_rays * std::max(1.0, noise)));
}

bool less_evident(const Mode& a, const Mode& b) {
    return a.log_evidence < b.log_evidence;
}

}  // namespace

// The tracked pose and the best modes of the swarm and among the rivals are refined side by side. The tracked one stays
// unless another one's present cost is clearly better: one early wrong lock must not last.
bool PoseEstimator::take_refined_mode(const Observation& observation, UpdateResult& result) {
    const auto begin = std::chrono::steady_clock::now();
    const Refinement refinement = refinement_now();
    std::vector<Mode> modes = modes_to_refine(observation, result);
    const int count = affordable(Stage::kModes, static_cast<int>(modes.size()), 1, result);
    const bool all_refined = count == static_cast<int>(modes.size());
    modes.resize(count);
    std::vector<Mode> refined = refine_all(modes, observation, result);
    if (confidence_ > 0.0 && !searching_) {  // where little is in view, refinement may slide off what was accepted
        const MovedParticle prediction = foretold_ ? *foretold_ : tracked_unmoved(observation);
        if (prediction.log_evidence > refined.front().log_evidence) refined.front() = mode_of(prediction);
    }
    const Eigen::Vector3d centre = views_->extent().centre_in_object();
    result.modes = distinct_modes(refined, static_cast<int>(refined.size()), centre, mode_distance());
    const Mode& tracked = refined.front();
    const int stride = grid_for(observation, refinement.max_rays).stride;
    const Mode* most = &*std::max_element(result.modes.begin(), result.modes.end(), less_evident);
    const bool replaced =
        !tracked_ || most->log_evidence >
                         tracked.log_evidence + std::max(refinement.challenge_nats, confidence_ / (stride * stride));
    Mode chosen = replaced ? *most : tracked;
    if (searching_everywhere(observation)) chosen = look_closer(chosen, observation, result);
    set_weights(result.modes);
    result.seconds.refinement = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    if (chosen.support < refinement.min_support) return false;
    const bool other =
        tracked_ && !same_mode(chosen.camera_from_object, tracked.camera_from_object, centre, mode_distance());
    result.mode_replaced = replaced && other;
    if (result.mode_replaced) rivals_tried_ = false;
    tracked_ = chosen;
    if (refinement.fusion) correct_tracked(chosen, result.mode_replaced, observation);
    weigh_rivals(result, result.effort.rivals > 0 && all_refined);
    result.score = std::clamp(1.0 - chosen.cost, 0.0, 1.0);
    // The swarm learns of it in place of its least likely member.
    const auto worst = std::max_element(particles_.weights.begin(), particles_.weights.end());
    particles_.poses[worst - particles_.weights.begin()] = chosen.camera_from_object;
    *worst = particles_.weights[map_index(particles_.weights)];
    return true;
}

// Where nothing is segmented a search compares modes all over the image with few rays on each. The chosen one and those
// around it are told apart by as many rays on the object alone. Gives the best of them.
Mode PoseEstimator::look_closer(const Mode& chosen, const Observation& observation, UpdateResult& result) {
    constexpr std::size_t kMost = 4;  // beside the chosen one and its likenesses
    const Eigen::Vector3d centre = views_->extent().centre_in_object();
    const double around_m = 0.5 * views_->extent().diameter_m();
    std::vector<Mode> near = {chosen}, far;
    const std::vector<Mode> alike = near_modes(near);
    near.insert(near.end(), alike.begin(), alike.end());
    const std::size_t most = near.size() + kMost;
    for (const Mode& mode : result.modes) {
        const double away_m = (mode.camera_from_object * centre - chosen.camera_from_object * centre).norm();
        (away_m < around_m && near.size() < most ? near : far).push_back(mode);
    }
    close_up_ = chosen.camera_from_object;
    if (options_.method.refinement.rivals > 0) {
        const std::vector<Mode> rivals = best_rivals({chosen}, observation, result);
        near.insert(near.end(), rivals.begin(), rivals.end());
    }
    bring_to_one_representative(near);
    near = refine_all(near, observation, result);
    for (Mode& mode : far) {  // has lost by as much as before
        mode.log_evidence += near.front().log_evidence - chosen.log_evidence;
        near.push_back(mode);
    }
    result.modes = distinct_modes(near, static_cast<int>(near.size()), centre, mode_distance());
    std::stable_sort(result.modes.begin(), result.modes.end(),
                     [](const Mode& a, const Mode& b) { return a.log_evidence > b.log_evidence; });
    return *std::max_element(near.begin(), near.end(), less_evident);
}

std::vector<Mode> PoseEstimator::refine_all(const std::vector<Mode>& modes, const Observation& observation,
                                            UpdateResult& result) {
    const Refinement refinement = refinement_now();
    const StepContext context = fine_context(grid_for(observation, refinement.max_rays), observation);
    const auto begin = std::chrono::steady_clock::now();
    const int count = static_cast<int>(modes.size());
    std::vector<MovedParticle> moved(modes.size());
    if (foretold_ && count == 1) {
        moved[0] = *foretold_;  // the fine fit needs no rounds before it
    } else {
        parallel_for(count, options_.num_threads,
                     [&](int k) { moved[k] = refine_mode(modes[k].camera_from_object, context, refinement); });
    }
    result.effort.modes += count;
    budget_.took(Stage::kModes, count, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    std::vector<Mode> refined;
    for (const MovedParticle& mode : moved) {
        refined.push_back(mode_of(mode));
        result.counts += mode.counts;
        result.seconds.stages += mode.seconds;
    }
    return refined;
}

// How much more the pixels speak for a pose than for no object at all [nats].
double PoseEstimator::evidence_of(const PixelCost& pixels) const {
    const PixelCostOptions& options = options_.method.pixel_cost;
    const double rays_per_evidence = options_.method.refinement.rays_per_evidence;
    PixelCost nothing = pixels;
    nothing.cost = 1.0;
    return log_evidence(pixels, options, rays_per_evidence) - log_evidence(nothing, options, rays_per_evidence);
}

// Whether the image speaks for a fit as much as for the prediction that it contradicts, and says as much about it as
// the one did in which the pose was accepted last.
bool PoseEstimator::tells_as_much(const Pose& fitted, const StepContext& context) const {
    const auto evidence_for = [&](const Pose& pose) {
        return evidence_of(refined_cost(pose, context, refinement_now()));
    };
    const int stride = context.observed.grid.stride;
    const double evidence = evidence_for(fitted);
    return evidence * stride * stride >= confidence_ && evidence >= evidence_for(track_->camera_from_object);
}

// The chosen mode's fine fit and the track that the arm's motion carried, brought together. Where they contradict each
// other the object was moved, unless the image says less than before or less for the fit: then the prediction stands.
void PoseEstimator::correct_tracked(const Mode& chosen, bool replaced, const Observation& observation) {
    const Method& method = options_.method;
    const int rays = effort_ == Effort::kKeeping ? fit_rays(method, observation) : method.refinement.max_rays;
    const StepContext context = fine_context(grid_to_fit(chosen.camera_from_object, observation, rays), observation);
    const FineFit fit = fit_finely(chosen.camera_from_object, context);
    const Eigen::Vector3d centre = views_->extent().centre_in_object();
    observed_ = fit.covariance + fit.constant_covariance;
    if (!track_ || replaced)
        track_ = Track{fit.camera_from_object, fit.covariance, {}, fit.constant_covariance};
    else if (!contradicts(*track_, fit, centre) || tells_as_much(fit.camera_from_object, context))
        track_ = correct_track(*track_, fit, centre);
    tracked_->camera_from_object = track_->camera_from_object;
}

// The tracked mode first (where there is one), then where it was before a loss, the swarm's, among them the best starts
// of a search, then the rivals.
std::vector<Mode> PoseEstimator::modes_to_refine(const Observation& observation, UpdateResult& result) {
    const Refinement& refinement = options_.method.refinement;
    const Eigen::Vector3d centre = views_->extent().centre_in_object();
    std::vector<Mode> swarm;
    for (int i = 0; i < particles_.size(); ++i) swarm.push_back({particles_.poses[i], last_costs_[i], 0.0});
    std::vector<Mode> leaders = searching_everywhere(observation) && refinement.shortlist > 0
                                    ? shortlisted(swarm, observation, result)
                                    : distinct_modes(swarm, refinement.modes, centre, mode_distance());
    std::vector<Mode> modes;
    // Once a mode convinced, one start is enough for it: its prediction where the arm's motion foretold it, else the
    // particle that came nearest, as where the object moves.
    const bool twice =
        effort_ != Effort::kWhole && !leaders.empty() &&
        same_mode(leaders.front().camera_from_object, tracked_->camera_from_object, centre, mode_distance());
    if (twice && !foretold_)
        modes.push_back(leaders.front());
    else if (tracked_)
        modes.push_back(*tracked_);
    if (twice) leaders.erase(leaders.begin());
    if (before_loss_) modes.push_back({*before_loss_, 1.0, 0.0});  // it may only have been hidden for a while
    modes.insert(modes.end(), leaders.begin(), leaders.end());
    if (refinement.shortlist == 0)
        for (const Pose& pose : screened_) modes.push_back({pose, 1.0, 0.0});
    // A search tries those of the mode that it has chosen.
    if (refinement.rivals > 0 && rivals_due() && !searching_everywhere(observation)) {
        const std::vector<Mode> near = near_modes(modes);
        const std::vector<Mode> rivals = best_rivals(modes, observation, result);
        modes.insert(modes.end(), near.begin(), near.end());
        modes.insert(modes.end(), rivals.begin(), rivals.end());
    }
    bring_to_one_representative(modes);
    return modes;
}

// Of the swarm's modes and the best starts, each refined a little on few rays where it puts the object, those that
// explain most of the image: before that a wrong one may outdo the right one.
std::vector<Mode> PoseEstimator::shortlisted(const std::vector<Mode>& swarm, const Observation& observation,
                                             UpdateResult& result) {
    constexpr int kKept = 8, kRays = 800, kRounds = 3;
    const auto begin = std::chrono::steady_clock::now();
    const Eigen::Vector3d centre = views_->extent().centre_in_object();
    Refinement refinement = refinement_now();
    refinement.rounds = std::min(refinement.rounds, kRounds);
    const std::vector<Mode> distinct = distinct_modes(swarm, refinement.shortlist, centre, mode_distance());
    std::vector<Mode> modes;
    for (std::size_t k = 0; k < std::max(distinct.size(), screened_.size()); ++k) {
        if (k < distinct.size()) modes.push_back(distinct[k]);
        if (k < screened_.size()) modes.push_back({screened_[k], 1.0, 0.0});
    }
    const int count = affordable(Stage::kShortlist, static_cast<int>(modes.size()), 1, result);
    modes.resize(count);
    std::vector<MovedParticle> moved(modes.size());
    parallel_for(count, options_.num_threads, [&](int k) {
        const Pose& pose = modes[k].camera_from_object;
        const ObservedGrid observed = observe(observation, grid_around(pose, observation, kRays));
        moved[k] = refine_mode(pose, context_for(observation, observed, options_.method.step), refinement);
        modes[k] = {moved[k].camera_from_object, -moved[k].gain * observed.grid.stride * observed.grid.stride, 0.0};
    });
    for (const MovedParticle& mode : moved) {
        result.counts += mode.counts;
        result.seconds.stages += mode.seconds;
    }
    budget_.took(Stage::kShortlist, count,
                 std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    return distinct_modes(modes, kKept, centre, mode_distance());
}

// The object may be anywhere in the image.
bool PoseEstimator::searching_everywhere(const Observation& observation) const {
    return searching_ && !observation.segmented();
}

// For a while, told from its rivals by the image, and it convinces.
bool PoseEstimator::one_mode_holds() const {
    return frames_held_ >= options_.method.refinement.frames_to_hold && rival_weight_ < kMostRivalWeight &&
           frames_lost_ == 0;
}

// What the image says of the prediction as it is.
MovedParticle PoseEstimator::tracked_unmoved(const Observation& observation) {
    const Refinement refinement = refinement_now();
    const StepContext context = fine_context(grid_for(observation, refinement.max_rays), observation);
    return refine_mode(tracked_->camera_from_object, context, unmoved(refinement));
}

// The prediction of an accepted pose by the measured motion of the arm, if the image agrees with it.
std::optional<MovedParticle> PoseEstimator::foretold_pose(const Observation& observation) {
    const MovedParticle pose = tracked_unmoved(observation);
    return pose.agreement >= kConvincingAgreement ? std::optional(pose) : std::nullopt;
}

// Rivals are tried in every frame until one mode holds.
bool PoseEstimator::rivals_due() const {
    const Refinement& refinement = options_.method.refinement;
    return !one_mode_holds() || step_ % static_cast<std::uint64_t>(refinement.rival_period) == 0;
}

// What the best mode may be mistaken for by the part's own shape.
std::vector<Mode> PoseEstimator::near_modes(const std::vector<Mode>& modes) const {
    std::vector<Mode> near;
    if (modes.empty()) return near;
    for (const Pose& turn : options_.symmetries.near) {
        Mode mode = modes.front();
        mode.camera_from_object = mode.camera_from_object * turn;
        near.push_back(mode);
    }
    return near;
}

// Of the poses in which a symmetric part looks the same, the one nearest to where it was before: it does not flip.
void PoseEstimator::bring_to_one_representative(std::vector<Mode>& modes) const {
    if (options_.symmetries.empty() || modes.empty()) return;
    const Pose reference = modes.front().camera_from_object;
    for (Mode& mode : modes)
        mode.camera_from_object = nearest_equivalent(mode.camera_from_object, reference, options_.symmetries,
                                                     views_->extent().centre_in_object());
}

// How sure it is that the tracked mode is the right one: kept until rivals are tried again.
void PoseEstimator::weigh_rivals(const UpdateResult& result, bool tried) {
    frames_held_ = result.mode_replaced ? 0 : frames_held_ + 1;
    if (!tried) return;
    rivals_tried_ = true;
    rival_weight_ = 0.0;
    for (const Mode& mode : result.modes) {
        if (!same_mode(mode.camera_from_object, tracked_->camera_from_object, views_->extent().centre_in_object(),
                       mode_distance()))
            rival_weight_ += mode.weight;
    }
}

std::vector<Mode> PoseEstimator::best_rivals(const std::vector<Mode>& leaders, const Observation& observation,
                                             UpdateResult& result) {
    const auto begin = std::chrono::steady_clock::now();
    Refinement refinement = refinement_now();
    refinement.rivals = affordable(Stage::kRivals, refinement.rivals, 0, result);
    if (refinement.rivals == 0) return {};
    constexpr std::size_t kLeaders = 2;
    const std::size_t used = std::min(leaders.size(), kLeaders);
    std::vector<Pose> proposals;
    for (std::size_t k = 0; k < used; ++k) {
        const int count = refinement.rivals / static_cast<int>(used);
        const std::vector<Pose> rivals =
            rivals_of(leaders[k].camera_from_object, views_->extent(), count, options_.seed + k, step_);
        proposals.insert(proposals.end(), rivals.begin(), rivals.end());
    }
    GradientStep step = options_.method.start_step;
    step.max_rays = std::min(step.max_rays, step_now().max_rays);
    const std::vector<MovedParticle> moved = move_all(proposals, observation, step, RandomPurpose::kRivals, result);
    result.effort.rivals = static_cast<int>(moved.size());
    budget_.took(Stage::kRivals, result.effort.rivals,
                 std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    std::vector<Mode> modes;
    for (const MovedParticle& rival : moved) modes.push_back({rival.camera_from_object, rival.cost, rival.support});
    return distinct_modes(modes, refinement.rival_modes, views_->extent().centre_in_object(), mode_distance());
}

ModeDistance PoseEstimator::mode_distance() const {
    constexpr double kRotation_rad = 0.15;
    constexpr double kTranslationDiameters = 0.03;
    return {kRotation_rad, kTranslationDiameters * views_->extent().diameter_m()};
}

}  // namespace nearpose
