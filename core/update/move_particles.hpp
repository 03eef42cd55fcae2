// The filter's step: each particle is moved towards the image and weighed (the paper's gradient step and likelihood).
#pragma once

#include <vector>

#include "core/base/random.hpp"
#include "core/update/frame.hpp"
#include "core/update/situation.hpp"

namespace nearpose {

// Moves poses (camera_from_object) by `step` and weighs them. Pose i uses the random stream (seed, frame's step, i).
// Where nothing is segmented and the object may be anywhere, each pose is judged where it puts the object.
std::vector<MovedParticle> move_poses(const std::vector<Pose>& poses, const GradientStep& step, RandomPurpose purpose,
                                      const Window& window, const Frame& frame, Ledger& ledger);

struct MovedParticles {
    ParticleSet particles;
    std::vector<double> costs;  // of the particles, in their order
    double effective_sample_size = 0.0;
};

MovedParticles move_particles(const ParticleSet& predicted, const Situation& situation, const Frame& frame,
                              Ledger& ledger);

}  // namespace nearpose
