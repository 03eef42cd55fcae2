#include "core/update/search.hpp"

#include <algorithm>
#include <numeric>

#include "core/base/parallel.hpp"
#include "core/search/sampling.hpp"
#include "core/update/move_particles.hpp"
#include "core/update/ray_grids.hpp"

namespace nearpose {
namespace {

// Hypotheses from pairs of oriented points: `count` candidates, a share of which these are. None without a table of
// pairs.
ParticleSet sample_on_pairs(Situation& situation, int count, int draws, const Frame& frame) {
    ParticleSet particles;
    if (!situation.window.surfels) return particles;
    const PreselectionOptions& preselection = frame.method().preselection;
    const int kept = preselection.tried > 0 ? preselection.tried : preselection.kept;
    const bool segmented = frame.observation.segmented();
    const PairSearchOptions options{(segmented ? 1 : frame.method().search.draws_factor_unsegmented) * draws,
                                    segmented ? count / 2 : 2 * count / 3, static_cast<std::uint64_t>(count),
                                    frame.options.num_threads};
    particles.poses = hypotheses_from_pairs(frame.observation, *frame.model.point_pairs, *situation.window.surfels,
                                            options, frame.options.seed, frame.step);
    const auto first = particles.poses.begin();
    if (!segmented) situation.best_from_pairs.assign(first, first + std::min(kept, particles.size()));
    return particles;
}

// A whole object in view is found from the centroid of what is seen, a part of one from its surface, and one among
// other things from pairs of oriented points: a share of the candidates each. Where nothing is segmented there is no
// centroid to go by. Empty if no surface shows a normal.
ParticleSet sample_where_surfaces_meet(Situation& situation, int count, int draws, const Frame& frame) {
    const Observation& observation = frame.observation;
    const EstimatorOptions& options = frame.options;
    ParticleSet particles = sample_on_pairs(situation, count, draws, frame);
    const int left = count - particles.size();
    const int on_sphere = observation.segmented() ? left / 2 : 0;
    ParticleSet centred = sample_on_sphere(observation, frame.model.extent(), on_sphere, options.seed, frame.step);
    const PixelGrid grid = ray_grid(frame, std::nullopt, frame.method().search.step.max_rays);
    const PinholeCamera coarse = camera_of(grid, observation.camera());
    parallel_for(on_sphere, options.num_threads, [&](int i) {
        for (int round = 0; round < 2; ++round)  // the first shift changes what is seen
            centred.poses[i] = shift_to_seen_surface(centred.poses[i], observation, *frame.model.views, coarse);
    });
    const std::vector<OrientedPoint>& surface =
        frame.model.point_pairs ? frame.model.point_pairs->points() : frame.model.surface_points;
    const ParticleSet on_surface =
        sample_on_surface(observation, surface, left - on_sphere, options.seed, frame.step, on_sphere);
    particles.poses.insert(particles.poses.end(), centred.poses.begin(), centred.poses.end());
    particles.poses.insert(particles.poses.end(), on_surface.poses.begin(), on_surface.poses.end());
    return particles;
}

// The candidates after a short gradient step, as many as there are to be particles, best first.
std::vector<Pose> best_candidates(const std::vector<Pose>& candidates, const Window& window, const Frame& frame,
                                  Ledger& ledger) {
    const std::vector<MovedParticle> moved =
        move_poses(candidates, frame.method().search.step, RandomPurpose::kStart, window, frame, ledger);
    std::vector<int> order(moved.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(),
                     [&](int a, int b) { return moved[a].negative_log_likelihood < moved[b].negative_log_likelihood; });
    const int kept = ledger.affordable(Stage::kParticles, frame.options.num_particles, 1);
    order.resize(std::min<std::size_t>(order.size(), kept));
    std::vector<Pose> best;
    for (const int index : order) best.push_back(moved[index].camera_from_object);
    return best;
}

}  // namespace

ParticleSet search(Situation& situation, const Frame& frame, Ledger& ledger) {
    const SearchOptions& method = frame.method().search;
    const EstimatorOptions& options = frame.options;
    if (frame.model.point_pairs) {
        situation.window.surfels = std::make_shared<const SurfelGrid>(
            surfels_of(frame.observation, *frame.model.point_pairs, options.seed, frame.step));
    }
    const Stopwatch watch;
    const int wanted = std::max(method.candidates, options.num_particles);
    const int count =
        ledger.affordable(Stage::kSearch, wanted, method.least_candidates);  // the next search tries others
    const auto draws = static_cast<int>(static_cast<double>(method.draws) * count / wanted);
    ParticleSet particles;
    if (method.initialisation != Initialisation::kSphere)
        particles = sample_where_surfaces_meet(situation, count, draws, frame);
    if (particles.size() == 0)
        particles = sample_on_sphere(frame.observation, frame.model.extent(), count, options.seed, frame.step);
    if (method.candidates > 0) particles.poses = best_candidates(particles.poses, situation.window, frame, ledger);
    particles.negative_log_weights.assign(particles.poses.size(), 0.0);
    ledger.effort.starts = count;
    ledger.seconds.start = watch.elapsed_s();
    ledger.budget.took(Stage::kSearch, count, ledger.seconds.start);
    return particles;
}

}  // namespace nearpose
