#include "core/update/search.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "core/base/parallel.hpp"
#include "core/search/sampling.hpp"
#include "core/update/move_particles.hpp"
#include "core/update/ray_grids.hpp"

namespace nearpose {
namespace {

// Candidates from pairs of oriented points, best first: up to their share of `count`. None without surfels.
std::vector<Pose> sample_on_pairs(const SurfelGrid* surfels, int count, double share_of_search, const Frame& frame) {
    if (surfels == nullptr) return {};
    const SearchOptions& options = frame.method().search;
    const bool segmented = frame.observation.segmented();
    const double share = segmented ? options.pair_share_segmented : options.pair_share_unsegmented;
    const int draws = (segmented ? 1 : options.draws_factor_unsegmented) * options.draws;
    const PairDraws wanted{.draws = static_cast<int>(draws * share_of_search),
                           .count = static_cast<int>(count * share),
                           .share = share_of_search,
                           .first_stream = static_cast<std::uint64_t>(count),
                           .num_threads = frame.options.num_threads};
    return hypotheses_from_pairs(frame.observation, *frame.model.point_pairs, *surfels, options, wanted,
                                 frame.options.seed, frame.step);
}

// The first of them, which are refined as they are beside the particles' modes.
std::vector<Pose> best_of(const std::vector<Pose>& from_pairs, const PreselectionOptions& preselection) {
    const int kept = preselection.tried > 0 ? preselection.tried : preselection.kept;
    const auto count = std::min(static_cast<std::ptrdiff_t>(kept), std::ssize(from_pairs));
    return {from_pairs.begin(), from_pairs.begin() + count};
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
ParticleSet sample_from_all(std::vector<Pose> from_pairs, int count, const Frame& frame) {
    const Observation& observation = frame.observation;
    ParticleSet particles;
    particles.poses = std::move(from_pairs);
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
                                  int wanted, Ledger& ledger) {
    const std::vector<MovedParticle> moved =
        move_poses(candidates, frame.method().search.step, RandomPurpose::kStart, window, frame, ledger);
    std::vector<int> order(moved.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(),
                     [&](int a, int b) { return moved[a].negative_log_likelihood < moved[b].negative_log_likelihood; });
    const int kept = ledger.affordable(Stage::kParticles, wanted, 1);
    order.resize(std::min<std::size_t>(order.size(), kept));
    std::vector<Pose> best;
    for (const int index : order) best.push_back(moved[index].camera_from_object);
    return best;
}

}  // namespace

SearchResult search(const Plan& plan, const Frame& frame, Ledger& ledger) {
    const SearchOptions& options = frame.method().search;
    const std::uint64_t seed = frame.options.seed;
    SearchResult found;
    if (frame.model.point_pairs)
        found.surfels = std::make_shared<const SurfelGrid>(
            surfels_of(frame.observation, *frame.model.point_pairs, options, seed, frame.step));
    const Stopwatch watch;
    const int whole = std::max(options.candidates, frame.options.num_particles);
    const int wanted = share_of(plan, whole);
    // A search that the budget cuts short is followed by one that tries others.
    const int count = ledger.affordable(Stage::kSearch, wanted, options.least_candidates);
    const double share = static_cast<double>(count) / whole;
    if (options.initialisation != Initialisation::kSphere) {
        const std::vector<Pose> from_pairs = sample_on_pairs(found.surfels.get(), count, share, frame);
        if (!frame.observation.segmented()) found.best_from_pairs = best_of(from_pairs, frame.method().preselection);
        found.particles = sample_from_all(from_pairs, count, frame);
    }
    if (found.particles.size() == 0)
        found.particles = sample_on_sphere(frame.observation, frame.model.extent(), count, seed, frame.step);
    const Window everywhere{true, std::nullopt, found.surfels};
    if (options.candidates > 0)
        found.particles.poses = best_candidates(found.particles.poses, everywhere, frame,
                                                share_of(plan, frame.options.num_particles), ledger);
    found.particles.negative_log_weights.assign(found.particles.poses.size(), 0.0);
    ledger.effort.starts = count;
    ledger.seconds.start = watch.elapsed_s();
    ledger.budget.took(Stage::kSearch, count, ledger.seconds.start);
    return found;
}

}  // namespace nearpose
