// Which hypothesis is the estimate.
#pragma once

#include <vector>

#include "core/update/frame.hpp"
#include "core/update/move_particles.hpp"
#include "core/update/situation.hpp"

namespace nearpose {

struct Choice {
    bool seen = false;                      // false: no pose shows the object in this observation
    Mode mode;                              // the chosen one
    bool replaces_tracked = false;          // by another mode
    std::vector<Mode> modes;                // all that were refined, distinct, with weights
    std::vector<Alternative> alternatives;  // to the mode, by all frames so far
    bool alternatives_compared = false;     // with it in this frame, as many as were asked for
    double score = 0.0;                     // for the result, larger is better
};

// The paper's: the particle with the smallest weight.
Choice choose_map(const MovedParticles& moved, const Frame& frame);

// The default method's. Hypotheses are proposed and refined side by side. The tracked one stays unless the present
// image speaks clearly for another; so an early wrong choice does not last.
Choice choose_mode(const Belief& belief, const MovedParticles& moved, const Situation& situation, const Frame& frame,
                   Ledger& ledger);

// Whether a challenger replaces the tracked mode. Its log-odds must exceed the margin, and the evidence of the last
// accepted pose where that is more. `stride` is the spacing of the rays behind the present evidence [pixels].
bool overturns(double challenger_log_posterior, double tracked_log_posterior, int stride, const Lock& lock,
               const ChoiceOptions& options);

}  // namespace nearpose
