#include "core/update/fuse.hpp"

#include <algorithm>
#include <utility>

#include "core/fit/joint_fit.hpp"
#include "core/update/ray_grids.hpp"

namespace nearpose {
namespace {

// Noise is averaged over rays. Where the image is noisier than the sensor at contact, proportionally more are cast.
int fit_rays(const Situation& situation, const Frame& frame) {
    const Method& method = frame.method();
    if (situation.phase != Phase::kTracking) return method.refinement.max_rays;
    const Observation& observation = frame.observation;
    const double noise = observation.sigma_m(observation.mean_distance_m()) / observation.sensor().sigma_floor_m;
    return static_cast<int>(
        std::min<double>(method.refinement.max_rays, method.effort.fit_rays * std::max(1.0, noise)));
}

// Whether a fit that contradicts the prediction is to be believed: its evidence must not be less than that for the
// prediction, nor than that of the last accepted pose.
bool outweighs_prediction(const Pose& fitted, const Pose& predicted, const StepContext& context, const Lock& lock,
                          const Situation& situation, const Method& method) {
    const auto evidence_for = [&](const Pose& pose) {
        return log_evidence_over_nothing(refined_cost(pose, context, situation.plan.refinement), method.pixel_cost,
                                         method.refinement.rays_per_evidence);
    };
    const int stride = context.observed.grid.stride;
    const double evidence = evidence_for(fitted);
    return evidence * stride * stride >= lock.accepted_evidence && evidence >= evidence_for(predicted);
}

Continuity continuity_of(bool other_mode, bool contradicted, const Lock& before) {
    if (other_mode) return before.accepted_evidence > 0.0 ? Continuity::kOtherThanAccepted : Continuity::kOtherMode;
    return contradicted ? Continuity::kContradicted : Continuity::kAsPredicted;
}

// Where fit and prediction contradict each other, the object was moved: the fit counts. Where its evidence is too
// small, the prediction stands.
JointFit correct(Belief& belief, const Choice& choice, const Situation& situation, const Frame& frame, Ledger& ledger) {
    const Pose& chosen = choice.mode.camera_from_object;
    const PixelGrid grid = ray_grid_to_fit(frame, chosen, fit_rays(situation, frame));
    const StepContext context = frame.context(ledger.measured(grid, frame.observation), frame.method().step);
    const JointFit fit = fit_jointly(chosen, context, frame.method().fit);
    const Eigen::Vector3d centre = frame.model.centre_in_object();
    const bool anew = !belief.track || choice.replaces_tracked;
    const bool moved = !anew && contradicts(*belief.track, fit, centre, frame.method().track);
    const Continuity continuity = continuity_of(anew, moved, belief.lock);
    const bool believed = !moved || outweighs_prediction(fit.camera_from_object, belief.track->camera_from_object,
                                                         context, belief.lock, situation, frame.method());
    if (anew)
        belief.track = Track{fit.camera_from_object, fit.covariance, {}, fit.constant_covariance};
    else if (believed)
        belief.track = correct_track(*belief.track, fit, centre, frame.method().track);
    if (believed)
        belief.sightings =
            with_sighting(std::move(belief.sightings), fit, continuity, centre, frame.method().arm_check.sightings);
    belief.tracked->camera_from_object = belief.track->camera_from_object;
    return fit;
}

// The particles learn of the chosen pose in place of their least likely one.
void replace_least_likely(ParticleSet& particles, const Pose& chosen) {
    const auto worst = std::max_element(particles.negative_log_weights.begin(), particles.negative_log_weights.end());
    particles.poses[worst - particles.negative_log_weights.begin()] = chosen;
    *worst = particles.negative_log_weights[map_index(particles.negative_log_weights)];
}

}  // namespace

void adopt(Belief& belief, const MovedParticles& moved, const Choice& choice) {
    belief.particles = moved.particles;
    belief.tracked = choice.mode;
    belief.alternatives = choice.alternatives;
}

std::optional<JointFit> fuse(Belief& belief, const Choice& choice, const Situation& situation, const Frame& frame,
                             Ledger& ledger) {
    std::optional<JointFit> fit;
    if (frame.method().fusion) fit = correct(belief, choice, situation, frame, ledger);
    std::optional<double> alternatives_weight;
    if (choice.alternatives_compared) alternatives_weight = weight_of(belief.alternatives);
    belief.lock = after_choice(belief.lock, choice.replaces_tracked, ledger.effort.alternatives, alternatives_weight);
    replace_least_likely(belief.particles, choice.mode.camera_from_object);
    return fit;
}

}  // namespace nearpose
