#include "core/update/search.hpp"

#include <algorithm>
#include <numeric>

#include "core/base/parallel.hpp"
#include "core/search/sampling.hpp"
#include "core/update/move_particles.hpp"
#include "core/update/ray_grids.hpp"

namespace nearpose {
namespace {

// Candidates from pairs of oriented points: up to their share of `count`. None without a table of pairs.
ParticleSet sample_on_pairs(Situation& situation, int count, int draws, const Frame& frame) {
    ParticleSet particles;
    if (!situation.window.surfels) return particles;
    const SearchOptions& options = frame.method().search;
    const PreselectionOptions& preselection = frame.method().preselection;
    const int kept = preselection.tried > 0 ? preselection.tried : preselection.kept;
    const bool segmented = frame.observation.segmented();
    const double share = segmented ? options.pair_share_segmented : options.pair_share_unsegmented;
    const PairDraws wanted{.draws = (segmented ? 1 : options.draws_factor_unsegmented) * draws,
                           .count = static_cast<int>(count * share),
                           .first_stream = static_cast<std::uint64_t>(count),
                           .num_threads = frame.options.num_threads};
    particles.poses = hypotheses_from_pairs(frame.observation, *frame.model.point_pairs, *situation.window.surfels,
                                            options, wanted, frame.options.seed, frame.step);
    const auto first = particles.poses.begin();
    if (!segmented) situation.best_from_pairs.assign(first, first + std::min(kept, particles.size()));
    return particles;
}

// Candidates on the paper's sphere, shifted so that what is seen of each lies on what is measured.
ParticleSet sample_on_shifted_sphere(int count, const Frame& frame) {
    const Observation& observation = frame.observation;
    const SearchOptions& options = frame.method().search;
    ParticleSet particles = sample_on_sphere(observation, frame.model.extent(), count, frame.options.seed, frame.step);
    const PixelGrid grid = ray_grid(frame, std::nullopt, options.step.max_rays);
    const PinholeCamera coarse = camera_of(grid, observation.camera());
    parallel_for(count, frame.options.num_threads, [&](int i) {
        for (int shift = 0; shift < options.sphere_shifts; ++shift)
            particles.poses[i] = shift_to_seen_surface(particles.poses[i], observation, *frame.model.views, coarse);
    });
    return particles;
}

// A share of the candidates each for three cases. Among other things the object is found from pairs of oriented points.
// A whole one in view is found from the centroid of what is seen, which says nothing where no object is segmented. A
// part of one is found from its surface. Empty if no surface shows a normal.
ParticleSet sample_from_all(Situation& situation, int count, int draws, const Frame& frame) {
    const Observation& observation = frame.observation;
    ParticleSet particles = sample_on_pairs(situation, count, draws, frame);
    const int left = count - particles.size();
    const int on_sphere = observation.segmented() ? static_cast<int>(left * frame.method().search.sphere_share) : 0;
    const ParticleSet centred = sample_on_shifted_sphere(on_sphere, frame);
    const std::vector<OrientedPoint>& surface =
        frame.model.point_pairs ? frame.model.point_pairs->points() : frame.model.surface_points;
    const ParticleSet on_surface =
        sample_on_surface(observation, surface, left - on_sphere, frame.options.seed, frame.step, on_sphere);
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
            surfels_of(frame.observation, *frame.model.point_pairs, method, options.seed, frame.step));
    }
    const Stopwatch watch;
    const int wanted = std::max(method.candidates, options.num_particles);
    const int count =
        ledger.affordable(Stage::kSearch, wanted, method.least_candidates);  // the next search tries others
    const auto draws = static_cast<int>(static_cast<double>(method.draws) * count / wanted);
    ParticleSet particles;
    if (method.initialisation != Initialisation::kSphere) particles = sample_from_all(situation, count, draws, frame);
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
