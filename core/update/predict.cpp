#include "core/update/predict.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace nearpose {

int particles_wanted(const Belief& belief, const Frame& frame) {
    const AdaptiveEffort& effort = frame.method().effort;
    const int most = frame.options.num_particles;
    if (!effort.on || !settled(belief.lock, frame.method())) return most;
    const ParticleSet& particles = belief.particles;
    const double best = particles.negative_log_weights[map_index(particles.negative_log_weights)];
    std::vector<Mode> likely;
    for (int i = 0; i < particles.size(); ++i)
        if (particles.negative_log_weights[i] < best + effort.far_less_likely_nats)
            likely.push_back(mode_at(particles.poses[i], particles.negative_log_weights[i]));
    const std::vector<Mode> cells = frame.model.distinct(likely, particles.size());
    const int size = kld_sample_size(static_cast<int>(cells.size()), effort.kld_error);
    const int least = frame.now_from_before ? effort.min_particles : effort.min_particles_unmeasured;
    return std::clamp(size, std::min(least, most), most);
}

Belief predict(const Belief& before, const Frame& frame, Ledger& ledger) {
    Belief belief = before;
    belief.step = frame.step;
    if (belief.particles.size() == 0) return belief;
    const FilterOptions& filter = frame.method().filter;
    const EstimatorOptions& options = frame.options;
    const std::optional<Pose>& motion = frame.now_from_before;
    const Eigen::Vector3d centre = frame.model.centre_in_object();

    const int wanted = ledger.affordable(Stage::kParticles, particles_wanted(belief, frame), 1);
    if (wanted != belief.particles.size() || effective_sample_size(belief.particles.negative_log_weights) <
                                                 filter.resample_below * belief.particles.size()) {
        belief.particles = systematic_resample(belief.particles, wanted, options.seed, frame.step);
        ledger.resampled = true;
    }
    belief.lock = after_prediction(belief.lock, motion.has_value(), frame.method());
    if (motion) {
        propagate(belief.particles, *motion);
        if (belief.tracked) belief.tracked->camera_from_object = *motion * belief.tracked->camera_from_object;
        if (belief.pose_before_loss) belief.pose_before_loss = *motion * *belief.pose_before_loss;
    }
    belief.sightings = after_motion(std::move(belief.sightings), motion);
    if (belief.track) move_track(*belief.track, motion, options.motion_noise, centre);
    const double diameters = motion ? filter.diffusion_diameters : filter.unmeasured_diffusion_diameters;
    diffuse(belief.particles, {filter.diffusion_rotation_rad, diameters * frame.model.diameter_m()}, centre,
            options.seed, frame.step);
    return belief;
}

}  // namespace nearpose
