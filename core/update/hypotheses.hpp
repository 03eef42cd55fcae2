// Which poses may be the right one: modes of the particles, the tracked pose, and what it may be mistaken for.
#pragma once

#include <vector>

#include "core/update/frame.hpp"
#include "core/update/move_particles.hpp"
#include "core/update/situation.hpp"

namespace nearpose {

// To be refined, in this order: the tracked mode (where there is one), the pose before a loss, the best modes of the
// particles, near-symmetric poses, alternatives.
std::vector<Mode> propose(const Belief& belief, const MovedParticles& moved, const Situation& situation,
                          const Frame& frame, Ledger& ledger);

// What a pose may be mistaken for by the part's near-symmetries.
std::vector<Mode> near_symmetric_modes(const Mode& mode, const Symmetries& symmetries);

// The best of poses that the leading modes may be mistaken for by the shape of the part's box: turns, and shifts along
// its axes, each after a short gradient step.
std::vector<Mode> best_alternatives(const std::vector<Mode>& leaders, const Situation& situation, const Frame& frame,
                                    Ledger& ledger);

// Brings poses of a symmetric part to the one that is nearest to the first pose: the estimate does not flip between
// poses in which the part looks the same.
void bring_to_one_representative(std::vector<Mode>& modes, const ObjectModel& model);

}  // namespace nearpose
