// Refinement of hypotheses, and the gate of the predicted pose.
#pragma once

#include <optional>
#include <vector>

#include "core/update/frame.hpp"
#include "core/update/situation.hpp"

namespace nearpose {

// Refines modes on many rays, side by side. Where the image agrees with the predicted pose and it is the only mode, it
// is taken as it is: the joint fit needs no rounds before it.
std::vector<Mode> refine(const std::vector<Mode>& modes, const Situation& situation, const Frame& frame,
                         Ledger& ledger);

Mode mode_of(const RefinedMode& refined);

// Weighs the predicted pose without moving it.
RefinedMode evaluate_prediction(const Pose& predicted, const Situation& situation, const Frame& frame, Ledger& ledger);

// Compares the image with the predicted pose, where an accepted pose was carried by the arm's measured motion. Where
// the image agrees, the prediction enters the situation; phase and plan follow.
Situation gate_prediction(Situation situation, const Belief& predicted, const Frame& frame, Ledger& ledger);

}  // namespace nearpose
