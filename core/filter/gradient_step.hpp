// How one particle is moved and weighed: pure functions of (pose, observation).
#pragma once

#include "core/method.hpp"
#include "core/observation/observation.hpp"
#include "core/pose_solver.hpp"
#include "core/view_generator.hpp"

namespace nearpose {

// Times of the stages, summed over particles and threads [s].
struct StageSeconds {
    double views = 0.0;
    double association = 0.0;  // with rejection
    double solving = 0.0;
    double likelihood = 0.0;

    StageSeconds& operator+=(const StageSeconds& other);
};

// What became of pairs and solves, summed over particles and rounds.
struct StepCounts {
    long view_points = 0;
    long pairs = 0;  // after association
    long rejected_by_normal = 0;
    long rejected_by_consensus = 0;
    long solves = 0;
    long solves_with_too_few_pairs = 0;
    long solves_not_usable = 0;

    StepCounts& operator+=(const StepCounts& other);
};

struct MovedParticle {
    Pose camera_from_object;
    double negative_log_likelihood = 0.0;
    double cost = 0.0;          // the pixel cost, or epsilon [m^2]
    double support = 0.0;       // with the pixel cost: share of the model's rays that agree
    double log_evidence = 0.0;  // of a refined mode
    double agreement = 0.0;     // of a refined mode: share of the rays that judge it and agree
    double gain = 0.0;          // grid pixels by which the image is explained better than without the object; no mask
    StepCounts counts;
    StageSeconds seconds;
};

// All that the particles of one frame share.
struct StepContext {
    const ViewGenerator& views;
    const PoseSolver& solver;
    const Observation& observation;
    const ObservedGrid& observed;  // where views are cast
    const GradientStep& step;
    Cost cost = Cost::kPixels;
    PixelCostOptions pixel_cost;
    bool scale_by_overlap = true;  // as in Method
};

// The paper's inner loop: generate the view at the pose, then `rounds` times associate, reject, solve and move by gamma
// towards the solution; then weigh. For the pixel cost the view is cast again, so that the cost is that of the pose
// which is kept. `random` is used by the sample consensus.
MovedParticle move_particle(const Pose& camera_from_object, const StepContext& context, const RandomStream& random);

// A mode on its way to the bottom: like move_particle, but the view is cast anew every other round, pairs are
// projective, and the extra noise halves from round to round.
MovedParticle refine_mode(const Pose& camera_from_object, const StepContext& context, const Refinement& refinement);

// The pixels' verdicts on a refined pose.
PixelCost refined_cost(const Pose& camera_from_object, const StepContext& context, const Refinement& refinement);

}  // namespace nearpose
