// Part of PoseEstimator: where the particles start, at first and after a loss.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>

#include "core/estimator.hpp"
#include "core/parallel.hpp"

namespace nearpose {

void PoseEstimator::start(const Observation& observation, UpdateResult& result) {
    const auto begin = std::chrono::steady_clock::now();
    const Method& method = options_.method;
    const int wanted = std::max(method.start_candidates, options_.num_particles);
    constexpr int kLeast = 20;
    const int count = affordable(Stage::kSearch, wanted, kLeast, result);  // the next search tries others
    const auto draws = static_cast<int>(static_cast<double>(method.start_draws) * count / wanted);
    particles_ = method.start == Start::kSphere ? ParticleSet{} : start_where_surfaces_meet(observation, count, draws);
    if (particles_.size() == 0)
        particles_ = start_on_sphere(observation, views_->extent(), count, options_.seed, step_);
    if (method.start_candidates > 0) keep_best_starts(observation, result);
    particles_.weights.assign(particles_.poses.size(), 0.0);
    result.effort.starts = count;
    result.seconds.start = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    budget_.took(Stage::kSearch, count, result.seconds.start);
}

// A whole object in view is found from the centroid of what is seen, a part of one from its surface, and one among
// other things from pairs of oriented points: a share of the starts each. Where nothing is segmented there is no
// centroid to go by. Empty if no surface shows a normal.
ParticleSet PoseEstimator::start_where_surfaces_meet(const Observation& observation, int count, int draws) {
    const Method& method = options_.method;
    ParticleSet particles;
    if (pairs_ && patches_) {
        // Where nothing is segmented most draws miss the object.
        constexpr int kDrawsUnsegmented = 6;
        constexpr int kRefined = 8;
        const int kept = method.refinement.shortlist > 0 ? method.refinement.shortlist : kRefined;
        const bool segmented = observation.segmented();
        const PairStartOptions start{(segmented ? 1 : kDrawsUnsegmented) * draws, segmented ? count / 2 : 2 * count / 3,
                                     static_cast<std::uint64_t>(count), options_.num_threads};
        particles.poses = start_on_pairs(observation, *pairs_, *patches_, start, options_.seed, step_);
        const auto first = particles.poses.begin();
        if (!segmented) screened_.assign(first, first + std::min(kept, particles.size()));
    }
    const int left = count - particles.size();
    const int on_sphere = observation.segmented() ? left / 2 : 0;
    ParticleSet centred = start_on_sphere(observation, views_->extent(), on_sphere, options_.seed, step_);
    const PinholeCamera coarse = camera_of(grid_for(observation, method.start_step.max_rays), observation.camera());
    parallel_for(on_sphere, options_.num_threads, [&](int i) {
        for (int round = 0; round < 2; ++round)  // the first shift changes what is seen
            centred.poses[i] = shift_to_seen_surface(centred.poses[i], observation, *views_, coarse);
    });
    const ParticleSet on_surface = start_on_surface(observation, pairs_ ? pairs_->anchors() : anchors_,
                                                    left - on_sphere, options_.seed, step_, on_sphere);
    particles.poses.insert(particles.poses.end(), centred.poses.begin(), centred.poses.end());
    particles.poses.insert(particles.poses.end(), on_surface.poses.begin(), on_surface.poses.end());
    particles.weights.assign(particles.poses.size(), 0.0);
    return particles;
}

// An object that is not seen, or whose pose the image contradicts, is searched for anew; the prediction stays among the
// modes that are compared. A pose that only fails to convince is doubted at first and now and then: a model that is not
// quite the part never convinces.
bool PoseEstimator::search_again() const {
    constexpr int kAtFirst = 4, kPeriod = 16;  // frames
    const int period = options_.method.refinement.frames_to_search;
    if (options_.method.refinement.modes == 0 || period == 0) return false;
    if (frames_lost_ > 0) return frames_lost_ % period == 0;
    return doubtful_ && (frames_doubtful_ <= kAtFirst || frames_doubtful_ % kPeriod == 0);
}

void PoseEstimator::keep_best_starts(const Observation& observation, UpdateResult& result) {
    const std::vector<MovedParticle> moved =
        move_all(particles_.poses, observation, options_.method.start_step, RandomPurpose::kStart, result);
    std::vector<int> order(moved.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(),
                     [&](int a, int b) { return moved[a].negative_log_likelihood < moved[b].negative_log_likelihood; });
    const int kept = affordable(Stage::kParticles, options_.num_particles, 1, result);
    order.resize(std::min<std::size_t>(order.size(), kept));
    particles_.poses.clear();
    for (const int index : order) particles_.poses.push_back(moved[index].camera_from_object);
}

}  // namespace nearpose
