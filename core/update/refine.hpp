// Hypotheses on their way to the bottom, and the predicted pose as it is.
#pragma once

#include <optional>
#include <vector>

#include "core/update/frame.hpp"
#include "core/update/situation.hpp"

namespace nearpose {

// Refines modes on many rays, side by side. A single mode whose prediction the image agrees with is taken as it is: the
// joint fit needs no rounds before it.
std::vector<Mode> refine(const std::vector<Mode>& modes, const Situation& situation, const Frame& frame,
                         Ledger& ledger);

Mode mode_of(const RefinedMode& refined);

// What the image says of the predicted pose without moving it.
RefinedMode evaluate_prediction(const Pose& predicted, const Situation& situation, const Frame& frame, Ledger& ledger);

// Compares the image with the predicted pose, where a verified pose was carried by the measured motion of the arm. Sets
// the situation's prediction where the image agrees, and its phase and plan.
void gate_prediction(Situation& situation, const Belief& predicted, const Frame& frame, Ledger& ledger);

}  // namespace nearpose
