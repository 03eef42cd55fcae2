#include "core/estimator.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "core/check.hpp"
#include "core/information.hpp"
#include "core/parallel.hpp"

namespace nearpose {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

constexpr int kAnchors = 4000;

}  // namespace

void validate(const EstimatorOptions& options) {
    validate(options.method);
    check_option("num_particles", options.num_particles, 1, 1e6);
    check_option("num_threads", options.num_threads, 0, 4096);
    check_option("min_candidates", options.min_candidates, 1, 1e9);
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
    : views_(std::move(views)), solver_(std::move(solver)), options_(options) {
    if (!views_ || !solver_)
        throw std::invalid_argument("PoseEstimator: a view generator and a pose solver are needed");
    validate(options_);
    if (options_.method.start == Start::kSurface) anchors_ = find_anchors(*views_, kAnchors);
}

UpdateResult PoseEstimator::update(const Observation& observation, const std::optional<Pose>& now_from_before) {
    const Clock::time_point begin = Clock::now();
    UpdateResult result;
    ++step_;
    result.points_observed = observation.num_candidates();
    predict(now_from_before, result);
    bool seen = false;
    if (result.points_observed >= options_.min_candidates) {
        const ParticleSet predicted = particles_;
        if (particles_.size() == 0) start(observation, result);
        move_particles(observation, result);
        seen = options_.method.refinement.modes > 0 ? take_refined_mode(observation, result)
                                                    : take_map(observation, result);
        if (!seen) particles_ = predicted;  // not pulled onto something else; none yet: the next frame starts again
    }
    result.status = seen ? UpdateStatus::kEstimated : tracked_ ? UpdateStatus::kPredicted : UpdateStatus::kNoPose;
    if (tracked_) describe_estimate(observation, result);
    result.seconds.total = seconds_since(begin);
    return result;
}

void PoseEstimator::reset() {
    particles_ = {};
    last_costs_.clear();
    tracked_.reset();
    frames_held_ = 0;
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
    if (effective_sample_size(particles_.weights) < method.resample_below * particles_.size()) {
        particles_ = systematic_resample(particles_, options_.seed, step_);
        result.resampled = true;
    }
    if (now_from_before && is_valid(*now_from_before)) {  // a motion that is no motion was not measured
        propagate(particles_, *now_from_before);
        if (tracked_) tracked_->camera_from_object = *now_from_before * tracked_->camera_from_object;
    }
    const ModelExtent& extent = views_->extent();
    diffuse(particles_, {method.diffusion_rotation_rad, method.diffusion_diameters * extent.diameter_m()},
            extent.centre_in_object(), options_.seed, step_);
}

void PoseEstimator::start(const Observation& observation, UpdateResult& result) {
    const Clock::time_point begin = Clock::now();
    const Method& method = options_.method;
    const int count = std::max(method.start_candidates, options_.num_particles);
    particles_ = method.start == Start::kSurface ? start_where_surfaces_meet(observation, count) : ParticleSet{};
    if (particles_.size() == 0)
        particles_ = start_on_sphere(observation, views_->extent(), count, options_.seed, step_);
    if (method.start_candidates > 0) keep_best_starts(observation, result);
    particles_.weights.assign(particles_.poses.size(), 0.0);
    result.seconds.start = seconds_since(begin);
}

// A whole object in view is found from the centroid of what is seen, a part of one from its surface: half of the starts
// each. Where nothing is segmented there is no centroid to go by. Empty if no surface shows a normal.
ParticleSet PoseEstimator::start_where_surfaces_meet(const Observation& observation, int count) const {
    const int on_sphere = observation.segmented() ? count / 2 : 0;
    ParticleSet particles = start_on_sphere(observation, views_->extent(), on_sphere, options_.seed, step_);
    const int max_rays = options_.method.start_step.max_rays;
    const PinholeCamera coarse = camera_of(grid_for(observation, max_rays), observation.camera());
    parallel_for(on_sphere, options_.num_threads, [&](int i) {
        for (int round = 0; round < 2; ++round)  // the first shift changes what is seen
            particles.poses[i] = shift_to_seen_surface(particles.poses[i], observation, *views_, coarse);
    });
    const ParticleSet on_surface =
        start_on_surface(observation, anchors_, count - on_sphere, options_.seed, step_, on_sphere);
    particles.poses.insert(particles.poses.end(), on_surface.poses.begin(), on_surface.poses.end());
    particles.weights.assign(particles.poses.size(), 0.0);
    return particles;
}

void PoseEstimator::keep_best_starts(const Observation& observation, UpdateResult& result) {
    const std::vector<MovedParticle> moved =
        move_all(particles_.poses, observation, options_.method.start_step, RandomPurpose::kStart, result);
    std::vector<int> order(moved.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(),
                     [&](int a, int b) { return moved[a].negative_log_likelihood < moved[b].negative_log_likelihood; });
    order.resize(std::min<std::size_t>(order.size(), options_.num_particles));
    particles_.poses.clear();
    for (const int index : order) particles_.poses.push_back(moved[index].camera_from_object);
}

void PoseEstimator::move_particles(const Observation& observation, UpdateResult& result) {
    const Clock::time_point begin = Clock::now();
    const std::vector<MovedParticle> moved =
        move_all(particles_.poses, observation, options_.method.step, RandomPurpose::kSampleConsensus, result);
    std::vector<double> likelihoods;
    last_costs_.clear();
    for (int i = 0; i < particles_.size(); ++i) {
        particles_.poses[i] = moved[i].camera_from_object;
        likelihoods.push_back(moved[i].negative_log_likelihood);
        last_costs_.push_back(moved[i].cost);
    }
    update_weights(particles_, likelihoods);
    result.effective_sample_size = effective_sample_size(particles_.weights);
    result.seconds.particles = seconds_since(begin);
}

std::vector<MovedParticle> PoseEstimator::move_all(const std::vector<Pose>& poses, const Observation& observation,
                                                   const GradientStep& step, RandomPurpose purpose,
                                                   UpdateResult& result) const {
    const ObservedGrid observed = observe(observation, grid_for(observation, step.max_rays));
    const StepContext context = context_for(observation, observed, step);
    std::vector<MovedParticle> moved(poses.size());
    parallel_for(static_cast<int>(poses.size()), options_.num_threads, [&](int i) {
        moved[i] = move_particle(poses[i], context, RandomStream(options_.seed, step_, i, purpose));
    });
    for (const MovedParticle& particle : moved) {
        result.counts += particle.counts;
        result.seconds.stages += particle.seconds;
    }
    return moved;
}

bool PoseEstimator::take_map(const Observation& observation, UpdateResult& result) {
    const int best = map_index(particles_.weights);
    tracked_ = Mode{particles_.poses[best], last_costs_[best], 0.0};
    const double sigma_m = observation.sensor().sigma_m(observation.mean_distance_m());
    result.score = options_.method.cost == Cost::kPixels ? 1.0 - tracked_->cost
                                                         : 1.0 / (1.0 + tracked_->cost / (sigma_m * sigma_m));
    return true;
}

// The tracked pose and the best modes of the swarm and among the rivals are refined side by side. The tracked one stays
// unless another one's present cost is clearly better: one early wrong lock must not last.
bool PoseEstimator::take_refined_mode(const Observation& observation, UpdateResult& result) {
    const Clock::time_point begin = Clock::now();
    const Refinement& refinement = options_.method.refinement;
    const std::vector<Mode> refined = refine_all(modes_to_refine(observation, result), observation, result);
    const Eigen::Vector3d centre = views_->extent().centre_in_object();
    result.modes = distinct_modes(refined, static_cast<int>(refined.size()), centre, mode_distance());
    result.seconds.refinement = seconds_since(begin);
    const Mode& best = result.modes.front();
    const Mode& tracked = refined.front();
    const bool replaced = !tracked_ || best.cost < refinement.challenge_ratio * tracked.cost;
    const Mode chosen = replaced ? best : tracked;
    if (chosen.support < refinement.min_support) return false;
    result.mode_replaced = tracked_ && replaced &&
                           !same_mode(best.camera_from_object, tracked.camera_from_object, centre, mode_distance());
    frames_held_ = replaced ? 0 : frames_held_ + 1;
    tracked_ = chosen;
    result.score = 1.0 - chosen.cost;
    // The swarm learns of it in place of its least likely member.
    const auto worst = std::max_element(particles_.weights.begin(), particles_.weights.end());
    particles_.poses[worst - particles_.weights.begin()] = chosen.camera_from_object;
    *worst = particles_.weights[map_index(particles_.weights)];
    return true;
}

std::vector<Mode> PoseEstimator::refine_all(const std::vector<Mode>& modes, const Observation& observation,
                                            UpdateResult& result) const {
    const Refinement& refinement = options_.method.refinement;
    const ObservedGrid observed = observe(observation, grid_for(observation, refinement.max_rays));
    const StepContext context = context_for(observation, observed, options_.method.step);
    std::vector<MovedParticle> moved(modes.size());
    parallel_for(static_cast<int>(modes.size()), options_.num_threads,
                 [&](int k) { moved[k] = refine_mode(modes[k].camera_from_object, context, refinement); });
    std::vector<Mode> refined;
    for (const MovedParticle& mode : moved) {
        refined.push_back({mode.camera_from_object, mode.cost, mode.support});
        result.counts += mode.counts;
        result.seconds.stages += mode.seconds;
    }
    return refined;
}

// The tracked mode first (where there is one), then the swarm's, then the rivals.
std::vector<Mode> PoseEstimator::modes_to_refine(const Observation& observation, UpdateResult& result) const {
    const Refinement& refinement = options_.method.refinement;
    const Eigen::Vector3d centre = views_->extent().centre_in_object();
    std::vector<Mode> swarm;
    for (int i = 0; i < particles_.size(); ++i) swarm.push_back({particles_.poses[i], last_costs_[i], 0.0});
    const std::vector<Mode> leaders = distinct_modes(swarm, refinement.modes, centre, mode_distance());
    std::vector<Mode> modes;
    if (tracked_) modes.push_back(*tracked_);
    modes.insert(modes.end(), leaders.begin(), leaders.end());
    const bool holds = frames_held_ >= refinement.frames_to_hold;
    const bool due = !holds || step_ % static_cast<std::uint64_t>(refinement.rival_period) == 0;
    if (refinement.rivals > 0 && due) {
        const std::vector<Mode> rivals = best_rivals(modes, observation, result);
        modes.insert(modes.end(), rivals.begin(), rivals.end());
    }
    return modes;
}

std::vector<Mode> PoseEstimator::best_rivals(const std::vector<Mode>& leaders, const Observation& observation,
                                             UpdateResult& result) const {
    const Refinement& refinement = options_.method.refinement;
    constexpr std::size_t kLeaders = 2;
    const std::size_t used = std::min(leaders.size(), kLeaders);
    std::vector<Pose> proposals;
    for (std::size_t k = 0; k < used; ++k) {
        const int count = refinement.rivals / static_cast<int>(used);
        const std::vector<Pose> rivals =
            rivals_of(leaders[k].camera_from_object, views_->extent(), count, options_.seed + k, step_);
        proposals.insert(proposals.end(), rivals.begin(), rivals.end());
    }
    const std::vector<MovedParticle> moved =
        move_all(proposals, observation, options_.method.start_step, RandomPurpose::kRivals, result);
    std::vector<Mode> modes;
    for (const MovedParticle& rival : moved) modes.push_back({rival.camera_from_object, rival.cost, rival.support});
    return distinct_modes(modes, refinement.rival_modes, views_->extent().centre_in_object(), mode_distance());
}

StepContext PoseEstimator::context_for(const Observation& observation, const ObservedGrid& observed,
                                       const GradientStep& step) const {
    PixelCostOptions pixel_cost = options_.method.pixel_cost;
    pixel_cost.extra_sigma_m = step.extra_sigma_diameters * views_->extent().diameter_m();
    return {*views_,     *solver_,
            observation, observed,
            step,        options_.method.cost,
            pixel_cost,  options_.method.scale_by_overlap};
}

// Views are cast where the object may be: around the segmented pixels, or around the tracked pose, or everywhere.
PixelGrid PoseEstimator::grid_for(const Observation& observation, int max_rays) const {
    constexpr double kMargin = 0.2;  // of the box: model beyond the seen object must be able to show
    PixelBox box = observation.candidate_box();
    const PinholeCamera& camera = observation.camera();
    if (!observation.segmented() && tracked_) {
        const Eigen::Vector3d centre = tracked_->camera_from_object * views_->extent().centre_in_object();
        const double radius_m = 0.5 * views_->extent().diameter_m();
        if (centre.z() > 1.2 * radius_m) {
            const Eigen::Vector2d uv = camera.project(centre);
            const double radius = camera.fx * radius_m / (centre.z() - radius_m);
            box = {static_cast<int>(uv.x() - radius), static_cast<int>(uv.y() - radius),
                   static_cast<int>(uv.x() + radius), static_cast<int>(uv.y() + radius)};
        }
    }
    const int margin_u = static_cast<int>(kMargin * (box.last_u - box.first_u));
    const int margin_v = static_cast<int>(kMargin * (box.last_v - box.first_v));
    box = {std::max(0, box.first_u - margin_u), std::max(0, box.first_v - margin_v),
           std::min(camera.width, box.last_u + margin_u), std::min(camera.height, box.last_v + margin_v)};
    if (box.empty()) box = {0, 0, camera.width, camera.height};
    return grid_over(box, max_rays);
}

ModeDistance PoseEstimator::mode_distance() const {
    constexpr double kRotation_rad = 0.15;
    constexpr double kTranslationDiameters = 0.03;
    return {kRotation_rad, kTranslationDiameters * views_->extent().diameter_m()};
}

void PoseEstimator::describe_estimate(const Observation& observation, UpdateResult& result) const {
    result.camera_from_object = tracked_->camera_from_object;
    result.cost = tracked_->cost;
    const ObservedGrid observed = observe(observation, grid_for(observation, options_.method.refinement.max_rays));
    const StepContext context = context_for(observation, observed, options_.method.step);
    const SensorModel& sensor = observation.sensor();
    CovarianceOptions covariance;
    const double side = std::max(1.0, sensor.systematic_length_pixels / observed.grid.stride);
    covariance.rays_per_shared_error = side * side;
    covariance.systematic_sigma_m = sensor.systematic_sigma_m;
    covariance.prior_translation_m = 0.1 * views_->extent().diameter_m();
    result.covariance = covariance_of(pairs_at(tracked_->camera_from_object, context), covariance);
}

}  // namespace nearpose
