// Which hypothesis is the estimate.
#pragma once

#include <vector>

#include "core/update/frame.hpp"
#include "core/update/move_particles.hpp"
#include "core/update/situation.hpp"

namespace nearpose {

struct Choice {
    bool seen = false;              // false: no pose shows the object in this observation
    Mode mode;                      // the chosen one
    bool replaces_tracked = false;  // by another mode
    bool all_refined = true;        // false: the budget left hypotheses out
    std::vector<Mode> modes;        // all of them, distinct, with weights
    double score = 0.0;             // of the result, larger is better
};

// The paper's: the particle with the smallest weight.
Choice choose_map(const MovedParticles& moved, const Frame& frame);

// The default method's: hypotheses are proposed and refined side by side. The tracked one stays unless another one's
// present evidence is clearly better: one early wrong choice must not last.
Choice choose_mode(const Belief& belief, const MovedParticles& moved, const Situation& situation, const Frame& frame,
                   Ledger& ledger);

// Whether a challenger replaces the tracked mode: its log-odds must exceed the margin, or, where more of it is needed,
// the evidence of the last accepted pose. `stride` is that of the rays that the log evidences are of [pixels].
bool overturns(double challenger_log_evidence, double tracked_log_evidence, int stride, const Lock& lock,
               const ChoiceOptions& options);

}  // namespace nearpose
