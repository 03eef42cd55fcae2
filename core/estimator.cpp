#include "core/estimator.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include "core/check.hpp"
#include "core/parallel.hpp"

namespace nearpose {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

}  // namespace

void validate(const EstimatorOptions& options) {
    validate(options.method);
    check_option("num_particles", options.num_particles, 1, 1e6);
    check_option("num_threads", options.num_threads, 0, 4096);
    check_option("budget_s", options.budget_s, 0.0, 1e6);
    check_option("min_candidates", options.min_candidates, 1, 1e9);
    check_option("tolerance.translation_m", options.tolerance.translation_m, 1e-9, 1e6);
    check_option("tolerance.rotation_rad", options.tolerance.rotation_rad, 1e-9, 3.15);
    check_option("motion_noise.sigma_rotation_rad", options.motion_noise.sigma_rotation_rad, 0.0, 3.15);
    check_option("motion_noise.sigma_translation_m", options.motion_noise.sigma_translation_m, 0.0, 1e3);
    check_option("motion_noise.fraction", options.motion_noise.fraction, 0.0, 10.0);
    check_option("motion_noise.unknown_rotation_rad", options.motion_noise.unknown_rotation_rad, 0.0, 3.15);
    check_option("motion_noise.unknown_translation_m", options.motion_noise.unknown_translation_m, 0.0, 1e3);
}

const char* to_string(UpdateStatus status) {
    switch (status) {
        case UpdateStatus::kEstimated:
            return "estimated";
        case UpdateStatus::kPredicted:
            return "predicted";
        case UpdateStatus::kNoPose:
            return "no_pose";
    }
    return "";
}

PoseEstimator::PoseEstimator(std::shared_ptr<const ViewGenerator> views, std::shared_ptr<const PoseSolver> solver,
                             const EstimatorOptions& options)
    : views_(std::move(views)), solver_(std::move(solver)), options_(options), budget_(options.budget_s) {
    if (!views_ || !solver_)
        throw std::invalid_argument("PoseEstimator: a view generator and a pose solver are needed");
    validate(options_);
    if (options_.method.start == Start::kSurface) anchors_ = find_anchors(*views_);
    if (options_.method.start == Start::kPairs) pairs_.emplace(*views_);
}

UpdateResult PoseEstimator::update(const Observation& observation, const std::optional<Pose>& now_from_before) {
    update_began_ = Clock::now();
    UpdateResult result;
    ++step_;
    result.points_observed = observation.num_candidates();
    predict(now_from_before, result);
    bool seen = false;
    if (result.points_observed >= options_.min_candidates) {
        const ParticleSet predicted = particles_;
        searching_ = particles_.size() == 0 || search_again();
        effort_ = effort_needed();
        if (searching_ && tracked_ && !before_loss_) before_loss_ = tracked_->camera_from_object;
        if (!searching_ && one_mode_holds()) before_loss_.reset();
        if (searching_ && pairs_) patches_ = patches_of(observation, *pairs_, options_.seed, step_);
        if (searching_) start(observation, result);
        if (effort_ != Effort::kWhole && confidence_ > 0.0) {
            foretold_ = foretold_pose(observation);
            if (!foretold_) effort_ = Effort::kConfirming;
        }
        move_particles(observation, result);
        seen = options_.method.refinement.modes > 0 ? take_refined_mode(observation, result)
                                                    : take_map(observation, result);
        if (!seen) particles_ = predicted;  // not pulled onto something else; none yet: the next frame starts again
    }
    searching_ = false;
    patches_.reset();
    close_up_.reset();
    foretold_.reset();
    screened_.clear();
    result.status = seen ? UpdateStatus::kEstimated : tracked_ ? UpdateStatus::kPredicted : UpdateStatus::kNoPose;
    result.verdict = Verdict::kLost;
    if (tracked_) describe_estimate(observation, result);
    fine_.clear();
    remember(observation, result);
    UpdateSeconds& seconds = result.seconds;
    seconds.total = seconds_since(update_began_);
    budget_.took(Stage::kFit, 1, seconds.total - seconds.start - seconds.particles - seconds.refinement);
    return result;
}

// For how long the estimate has contradicted what is seen, for how long it has not been convincing, and how much it
// took to be accepted.
void PoseEstimator::remember(const Observation& observation, const UpdateResult& result) {
    constexpr double kContradicted = 0.8;
    const double agreement = result.verdict == Verdict::kLost ? 0.0 : result.pixels.agreement();
    frames_lost_ = agreement < kContradicted ? frames_lost_ + 1 : 0;
    const bool accepted = result.verdict == Verdict::kAccept;
    if (accepted) frames_doubtful_ = 0;
    doubtful_ = options_.method.refinement.doubts && agreement < kConvincingAgreement;
    frames_doubtful_ += doubtful_;
    const int stride = grid_for(observation, refinement_now().max_rays).stride;
    const double evidence =
        accepted && options_.method.refinement.confidence ? evidence_of(result.pixels) * stride * stride : 0.0;
    confidence_ = std::max(confidence_, evidence);
}

// What of `wanted` fits into the budget.
int PoseEstimator::affordable(Stage stage, int wanted, int least, UpdateResult& result) const {
    const int count = budget_.affordable(stage, wanted, least, seconds_since(update_began_));
    if (count < wanted) result.effort.reduced_for_budget = true;
    return count;
}

void PoseEstimator::reset() {
    particles_ = {};
    last_costs_.clear();
    tracked_.reset();
    before_loss_.reset();
    track_.reset();
    frames_held_ = frames_lost_ = frames_doubtful_ = 0;
    convinced_ = doubtful_ = false;
    confidence_ = 0.0;
    rivals_tried_ = false;
}

void PoseEstimator::reset(const Pose& camera_from_object, const Diffusion& spread) {
    if (!is_valid(camera_from_object))
        throw std::invalid_argument("PoseEstimator: the pose to start from is not a finite rigid transform");
    reset();
    particles_ =
        start_around(camera_from_object, spread, views_->extent(), options_.num_particles, options_.seed, step_);
    tracked_ = Mode{camera_from_object, 1.0, 0.0};
}

// Resampling where the weights have become uneven, then control and diffusion, as in the paper's algorithm.
void PoseEstimator::predict(const std::optional<Pose>& now_from_before, UpdateResult& result) {
    const Method& method = options_.method;
    if (particles_.size() == 0) return;
    std::optional<Pose> motion;
    if (now_from_before && is_valid(*now_from_before)) motion = now_from_before;  // otherwise it was not measured
    const int wanted = affordable(Stage::kParticles, particles_wanted(motion.has_value()), 1, result);
    if (wanted != particles_.size() ||
        effective_sample_size(particles_.weights) < method.resample_below * particles_.size()) {
        particles_ = systematic_resample(particles_, wanted, options_.seed, step_);
        result.resampled = true;
    }
    constexpr double kKept = 0.7;  // a frame: what was accepted once may have been moved since
    confidence_ *= motion ? kKept : 0.0;
    if (motion) {
        propagate(particles_, *motion);
        if (tracked_) tracked_->camera_from_object = *motion * tracked_->camera_from_object;
        if (before_loss_) before_loss_ = *motion * *before_loss_;
    }
    if (track_) move_track(*track_, motion, options_.motion_noise, views_->extent().centre_in_object());
    const ModelExtent& extent = views_->extent();
    const double diameters = motion ? method.diffusion_diameters : method.unmeasured_diffusion_diameters;
    diffuse(particles_, {method.diffusion_rotation_rad, diameters * extent.diameter_m()}, extent.centre_in_object(),
            options_.seed, step_);
}

// As many as describe the posterior: its cells are the swarm's modes that are not far less likely than the best.
int PoseEstimator::particles_wanted(bool motion_measured) const {
    const Economy& economy = options_.method.economy;
    if (!economy.on || !one_mode_holds()) return options_.num_particles;
    constexpr double kFarLessLikely_nats = 7.0;
    const double best = particles_.weights[map_index(particles_.weights)];
    std::vector<Mode> likely;
    for (int i = 0; i < particles_.size(); ++i)
        if (particles_.weights[i] < best + kFarLessLikely_nats)
            likely.push_back({particles_.poses[i], particles_.weights[i], 0.0});
    const std::vector<Mode> cells =
        distinct_modes(likely, particles_.size(), views_->extent().centre_in_object(), mode_distance());
    const int size = kld_sample_size(static_cast<int>(cells.size()), economy.kld_error);
    const int least = motion_measured ? economy.min_particles : economy.min_particles_unmeasured;
    return std::clamp(size, std::min(least, options_.num_particles), options_.num_particles);
}

void PoseEstimator::move_particles(const Observation& observation, UpdateResult& result) {
    const Clock::time_point begin = Clock::now();
    const std::vector<MovedParticle> moved =
        move_all(particles_.poses, observation, step_now(), RandomPurpose::kSampleConsensus, result);
    std::vector<double> likelihoods;
    last_costs_.clear();
    for (int i = 0; i < particles_.size(); ++i) {
        particles_.poses[i] = moved[i].camera_from_object;
        likelihoods.push_back(moved[i].negative_log_likelihood);
        last_costs_.push_back(moved[i].cost);
    }
    update_weights(particles_, likelihoods);
    result.effective_sample_size = effective_sample_size(particles_.weights);
    result.effort.particles = particles_.size();
    result.seconds.particles = seconds_since(begin);
    budget_.took(Stage::kParticles, particles_.size(), result.seconds.particles);
}

std::vector<MovedParticle> PoseEstimator::move_all(const std::vector<Pose>& poses, const Observation& observation,
                                                   const GradientStep& step, RandomPurpose purpose,
                                                   UpdateResult& result) const {
    std::vector<MovedParticle> moved(poses.size());
    const auto move = [&](int i, const ObservedGrid& observed) {
        moved[i] = move_particle(poses[i], context_for(observation, observed, step),
                                 RandomStream(options_.seed, step_, i, purpose));
    };
    const int count = static_cast<int>(poses.size());
    if (pairs_ && !observation.segmented() && !(tracked_ && !searching_)) {
        // The object may be anywhere in the image: each pose is judged where it puts the object.
        parallel_for(count, options_.num_threads, [&](int i) {
            const ObservedGrid observed = observe_on(grid_around(poses[i], observation, step.max_rays), observation);
            move(i, observed);
            weigh_against_image(observed.grid.stride, observation, moved[i]);
        });
    } else {
        const ObservedGrid observed = observe_on(grid_for(observation, step.max_rays), observation);
        parallel_for(count, options_.num_threads, [&](int i) { move(i, observed); });
    }
    for (const MovedParticle& particle : moved) {
        result.counts += particle.counts;
        result.seconds.stages += particle.seconds;
    }
    return moved;
}

// From the cost of one pose's own grid to what its cost would be on the whole image.
void PoseEstimator::weigh_against_image(int stride, const Observation& observation, MovedParticle& moved) const {
    const PixelCostOptions& options = options_.method.pixel_cost;
    PixelCost whole;
    whole.cost = options.unexplained_cost - moved.gain * stride * stride / std::max(1, observation.num_candidates());
    moved.cost = whole.cost;
    moved.negative_log_likelihood = negative_log_likelihood(whole, options);
}

bool PoseEstimator::take_map(const Observation& observation, UpdateResult& result) {
    const int best = map_index(particles_.weights);
    tracked_ = Mode{particles_.poses[best], last_costs_[best], 0.0};
    const double sigma_m = observation.sensor().sigma_m(observation.mean_distance_m());
    result.score = options_.method.cost == Cost::kPixels ? std::clamp(1.0 - tracked_->cost, 0.0, 1.0)
                                                         : 1.0 / (1.0 + tracked_->cost / (sigma_m * sigma_m));
    return true;
}

// While the object may be anywhere, planes that are too large to be its faces say little for a pose.
ObservedGrid PoseEstimator::observe_on(const PixelGrid& grid, const Observation& observation) const {
    ObservedGrid observed = observe(observation, grid);
    if (!patches_ || observation.segmented()) return observed;
    for (int index = 0; index < grid.size(); ++index) {
        const int pixel = grid.image_v(index) * observation.camera().width + grid.image_u(index);
        const Patch* patch = patches_->at(observation.camera(), pixel);
        observed.weights.push_back(patch == nullptr ? 1.0F : static_cast<float>(patch->weight));
    }
    return observed;
}

// On a grid that was measured once.
StepContext PoseEstimator::fine_context(const PixelGrid& grid, const Observation& observation) {
    auto kept = std::find_if(fine_.begin(), fine_.end(), [&](const ObservedGrid& other) { return other.grid == grid; });
    if (kept == fine_.end()) kept = fine_.insert(fine_.end(), observe(observation, grid));
    return context_for(observation, *kept, options_.method.step);
}

// Of an update that begins. An estimate that convinces must be confirmed, not found; once it holds it is kept.
PoseEstimator::Effort PoseEstimator::effort_needed() const {
    if (!options_.method.economy.on || searching_) return Effort::kWhole;
    if (one_mode_holds()) return Effort::kKeeping;
    // With a third of the rays the rivals are told apart by a third of the evidence.
    const double rays = refinement_now().max_rays;  // of the update before
    const double share = std::min(1.0, options_.method.economy.confirming_rays / rays);
    return convinced_ && std::pow(rival_weight_, share) <= kMostRivalWeight ? Effort::kConfirming : Effort::kWhole;
}

GradientStep PoseEstimator::step_now() const {
    GradientStep step = options_.method.step;
    if (effort_ != Effort::kWhole) step.max_rays = std::min(step.max_rays, options_.method.economy.step_rays);
    if (foretold_) step.rounds = std::min(step.rounds, options_.method.economy.step_rounds);
    return step;
}

Refinement PoseEstimator::refinement_now() const {
    Refinement refinement = options_.method.refinement;
    if (effort_ == Effort::kWhole) return refinement;
    const Economy& economy = options_.method.economy;
    const bool keeping = effort_ == Effort::kKeeping;
    refinement.max_rays = std::min(refinement.max_rays, keeping ? economy.rays : economy.confirming_rays);
    refinement.rounds = std::min(refinement.rounds, keeping ? economy.rounds : economy.confirming_rounds);
    if (keeping) refinement.rivals = std::min(refinement.rivals, economy.rivals);
    return refinement;
}

StepContext PoseEstimator::context_for(const Observation& observation, const ObservedGrid& observed,
                                       const GradientStep& step) const {
    PixelCostOptions pixel_cost = options_.method.pixel_cost;
    pixel_cost.extra_sigma_m = step.extra_sigma_diameters * views_->extent().diameter_m();
    pixel_cost.deep_m = options_.method.deep_diameters * views_->extent().diameter_m();
    return {*views_,     *solver_,
            observation, observed,
            step,        options_.method.cost,
            pixel_cost,  options_.method.scale_by_overlap};
}

void PoseEstimator::describe_estimate(const Observation& observation, UpdateResult& result) {
    result.camera_from_object = tracked_->camera_from_object;
    result.cost = tracked_->cost;
    const ModelExtent& extent = views_->extent();
    const StepContext context = fine_context(grid_for(observation, refinement_now().max_rays), observation);
    const Eigen::Vector3d centre = extent.centre_in_object();
    const bool estimated = result.status == UpdateStatus::kEstimated;
    if (!track_) observed_ = covariance_at(tracked_->camera_from_object, context);
    result.covariance = about_origin(track_ ? track_->whole_covariance() : observed_, centre);
    constexpr double kOneMetre = 1.0;
    result.observability = observability_of(estimated ? observed_ : Matrix6d(kOneMetre * Matrix6d::Identity()),
                                            0.5 * extent.diameter_m(), options_.tolerance.translation_m);
    const int num_modes = static_cast<int>(result.modes.size());
    const bool alone = num_modes == 1 && estimated;  // then it was fitted
    parallel_for(num_modes, options_.num_threads, [&](int k) {
        Mode& mode = result.modes[k];
        mode.covariance = about_origin(alone ? observed_ : covariance_at(mode.camera_from_object, context), centre);
    });
    Evidence evidence;
    evidence.seen = estimated;
    evidence.pixels = refined_cost(tracked_->camera_from_object, context, refinement_now());
    evidence.rival_weight = rival_weight_;
    evidence.rivals_tried = rivals_tried_;
    evidence.covariance_about_centre = about_centre(result.covariance, centre);
    convinced_ = convinces(evidence);
    result.verdict = judge(evidence, options_.tolerance, options_.symmetries);
    result.pixels = evidence.pixels;
}

}  // namespace nearpose
