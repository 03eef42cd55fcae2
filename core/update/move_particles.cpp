#include "core/update/move_particles.hpp"

#include <algorithm>

#include "core/base/parallel.hpp"
#include "core/update/ray_grids.hpp"

namespace nearpose {
namespace {

// During a search planes that are too large to be faces of the object say little for a pose.
ObservedGrid observe_weighted(const PixelGrid& grid, const Window& window, const Frame& frame) {
    const Observation& observation = frame.observation;
    ObservedGrid observed = observe(observation, grid);
    if (!window.surfels || observation.segmented()) return observed;
    for (int index = 0; index < grid.size(); ++index) {
        const int pixel = grid.image_v(index) * observation.camera().width + grid.image_u(index);
        const Surfel* surfel = window.surfels->at(observation.camera(), pixel);
        observed.weights.push_back(surfel == nullptr ? 1.0F : static_cast<float>(surfel->evidence_weight));
    }
    return observed;
}

// From the cost on the pose's own grid to what its cost would be on the whole image.
void weigh_against_image(int stride, const Frame& frame, MovedParticle& moved) {
    const PixelCostOptions& options = frame.method().pixel_cost;
    PixelCost whole;
    whole.cost =
        options.unexplained_cost - moved.gain * stride * stride / std::max(1, frame.observation.num_candidates());
    moved.cost = whole.cost;
    moved.negative_log_likelihood = negative_log_likelihood(whole, options);
}

}  // namespace

std::vector<MovedParticle> move_poses(const std::vector<Pose>& poses, const GradientStep& step, RandomPurpose purpose,
                                      const Window& window, const Frame& frame, Ledger& ledger) {
    const int count = static_cast<int>(poses.size()), threads = frame.options.num_threads;
    std::vector<MovedParticle> moved(poses.size());
    const auto move = [&](int i, const ObservedGrid& observed) {
        moved[i] = move_particle(poses[i], frame.context(observed, step),
                                 RandomStream(frame.options.seed, frame.step, i, purpose));
    };
    if (frame.model.point_pairs && !frame.observation.segmented() && window.everywhere) {
        parallel_for(count, threads, [&](int i) {
            const ObservedGrid observed =
                observe_weighted(ray_grid_on_model(frame, poses[i], step.max_rays), window, frame);
            move(i, observed);
            weigh_against_image(observed.grid.stride, frame, moved[i]);
        });
    } else {
        const ObservedGrid observed = observe_weighted(ray_grid(frame, window.around, step.max_rays), window, frame);
        parallel_for(count, threads, [&](int i) { move(i, observed); });
    }
    for (const MovedParticle& particle : moved) ledger.add(particle.counts, particle.seconds);
    return moved;
}

MovedParticles move_particles(const ParticleSet& predicted, const Situation& situation, const Frame& frame,
                              Ledger& ledger) {
    const Stopwatch watch;
    const std::vector<MovedParticle> moved = move_poses(
        predicted.poses, situation.plan.step, RandomPurpose::kSampleConsensus, situation.window, frame, ledger);
    MovedParticles result;
    result.particles = predicted;
    std::vector<double> negative_log_likelihoods;
    for (int i = 0; i < predicted.size(); ++i) {
        result.particles.poses[i] = moved[i].camera_from_object;
        negative_log_likelihoods.push_back(moved[i].negative_log_likelihood);
        result.costs.push_back(moved[i].cost);
    }
    update_weights(result.particles, negative_log_likelihoods);
    result.effective_sample_size = effective_sample_size(result.particles.negative_log_weights);
    ledger.effort.particles = predicted.size();
    ledger.seconds.particles = watch.elapsed_s();
    ledger.budget.took(Stage::kParticles, predicted.size(), ledger.seconds.particles);
    return result;
}

}  // namespace nearpose
