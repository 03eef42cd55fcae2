// What one image shows of the object at a pose: how its rays compare with the depth, and what planes do not explain.
#pragma once

#include <vector>

#include "core/evidence/background.hpp"
#include "core/update/frame.hpp"

namespace nearpose {

struct PoseEvidence {
    PixelCost pixels;
    PixelCost judged;  // the same for the verdict: what neighbouring rays are off together is no contradiction
    PositiveEvidence positive;
    double log_odds_present = 0.0;  // of the object at the pose against planes alone [nats]
};

// `shared_sigma_m` is that of the joint fit.
PoseEvidence evidence_at(const Pose& camera_from_object, const StepContext& context,
                         const RefinementOptions& refinement, const Frame& frame, double shared_sigma_m = 0.0);

// The same for several modes of a search, each on a ray grid of its own around where it puts the object. Takes from the
// evidence for a mode that which speaks for planes alone: so much less likely is the object there than nowhere.
void penalise_absent(std::vector<Mode>& modes, const RefinementOptions& refinement, const Frame& frame);

}  // namespace nearpose
