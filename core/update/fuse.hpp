// The chosen mode's joint fit and the prediction by the arm's motion, brought together.
#pragma once

#include <optional>

#include "core/update/belief.hpp"
#include "core/update/choose.hpp"
#include "core/update/frame.hpp"

namespace nearpose {

// The particles and the tracked mode become those of this frame.
void adopt(Belief& belief, const MovedParticles& moved, const Choice& choice);

// The default method's. The adopted mode is fitted jointly with the sensor's errors and fused with the track. The
// record of the lock takes the choice, and the chosen pose replaces the least likely particle. Gives this observation's
// own fit; nothing where fusion is off.
std::optional<JointFit> fuse(Belief& belief, const Choice& choice, const Situation& situation, const Frame& frame,
                             Ledger& ledger);

}  // namespace nearpose
