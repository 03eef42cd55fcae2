// Which poses may be the right one: modes of the particles, the tracked pose, and what it may be mistaken for.
#pragma once

#include <vector>

#include "core/update/frame.hpp"
#include "core/update/move_particles.hpp"
#include "core/update/situation.hpp"

namespace nearpose {

// The hypotheses to refine. First the tracked mode, or the particle that leads it; then the pose before a loss, the
// best modes of the particles, poses from pairs (without preselection), near-symmetric poses and alternatives.
std::vector<Mode> propose(const Belief& belief, const MovedParticles& moved, const Situation& situation,
                          const Frame& frame, Ledger& ledger);

// The poses that a mode may be mistaken for because of the part's near-symmetries.
std::vector<Mode> near_symmetric_modes(const Mode& mode, const Symmetries& symmetries);

// Poses that the leading modes may be mistaken for because of the shape of the part's box: turns about its axes and
// shifts along them, each after a short gradient step. The best of them.
std::vector<Mode> best_alternatives(const std::vector<Mode>& leaders, const Situation& situation, const Frame& frame,
                                    Ledger& ledger);

// Replaces each pose of a symmetric part by the equivalent one that is nearest to the first: the estimate does not flip
// between poses in which the part looks the same.
void move_to_nearest_equivalents(std::vector<Mode>& modes, const ObjectModel& model);

}  // namespace nearpose
