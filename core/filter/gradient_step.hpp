// How one particle is moved and weighed: pure functions of (pose, observation).
#pragma once

#include <string>

#include "core/base/random.hpp"
#include "core/evidence/likelihood.hpp"
#include "core/observation/observed_grid.hpp"
#include "core/pose_solver.hpp"
#include "core/view_generator.hpp"

namespace nearpose {

// How a view's points find measured ones, see association.hpp.
enum class Association { kNearest, kProjective };

// The gradient step of one particle: a few rounds of correspondence and least squares.
struct GradientStep {
    Association association = Association::kProjective;
    double max_distance_diameters = 0.1;  // of a pair
    double extra_sigma_diameters = 0.01;  // added to the sensor's noise: how far off the pose may still be
    double max_normal_angle_rad = 0.0;    // between a pair's normals; 0: not checked
    int consensus_draws = 0;              // of the sample-consensus rejection; 0: none
    double consensus_distance_diameters = 0.02;
    int rounds = 3;          // 0: the pose is weighed where it is
    double step_size = 1.0;  // gamma: the fraction of each solve that is taken, along the geodesic
    int max_rays = 400;      // of the view
};

// The refinement of a mode: the same on more rays, with a tolerance that shrinks.
struct RefinementOptions {
    int rounds = 5;                              // 0, inside the estimator: weighed where it is
    int rounds_per_view = 2;                     // a view is cast anew every so many: one moves it less than its rays
    int max_rays = 6000;                         // of the view
    double first_extra_sigma_diameters = 0.006;  // added to the sensor's noise in the first round
    double extra_sigma_decay = 0.5;              // of that noise, from round to round
    double gate_sigmas = 5.0;                    // a pair farther apart is not of the same surface
    double cost_sigma_diameters = 0.002;         // added to the sensor's noise in the cost that modes are compared by
    bool outline = true;                         // as PixelCostOptions::with_outline
    double rays_per_evidence = 10.0;             // neighbouring rays share errors: so many count as one
};

// Throw std::invalid_argument naming field, value and bound; `name` comes before the field.
void validate(const GradientStep& step, const std::string& name);
void validate(const RefinementOptions& options, const std::string& name);

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

// A particle after its step.
struct MovedParticle {
    Pose camera_from_object;
    double negative_log_likelihood = 0.0;
    double cost = 0.0;     // the pixel cost, or the paper's epsilon [m^2]
    double support = 0.0;  // with the pixel cost: share of the model's rays that agree with the measured depth
    double gain = 0.0;     // with the pixel cost: as PixelCost::gain [grid pixels]
    StepCounts counts;
    StageSeconds seconds;
};

// A mode after its refinement.
struct RefinedMode {
    Pose camera_from_object;
    double cost = 0.0;          // the pixel cost
    double support = 0.0;       // share of the model's rays that agree with the measured depth
    double log_evidence = 0.0;  // of the image for this pose, up to a constant [nats]
    double inlier_ratio = 0.0;  // share of the rays that say anything about the surface and agree with it
    double gain = 0.0;          // as PixelCost::gain [grid pixels]
    StepCounts counts;
    StageSeconds seconds;
};

// All that the particles of one frame share.
struct StepContext {
    const ViewGenerator& views;
    const PoseSolver& solver;
    const Observation& observation;
    const ObservedGrid& observed;  // where views are cast
    GradientStep step;
    Cost cost = Cost::kPixels;
    PixelCostOptions pixel_cost;
    bool scale_by_overlap = true;  // as in Method
};

// The paper's inner loop: generate the view at the pose, then `rounds` times associate, reject, solve and move by gamma
// towards the solution; then weigh. For the pixel cost the view is cast again, so that the cost belongs to the pose
// that is kept. `random` is used by the sample consensus.
MovedParticle move_particle(const Pose& camera_from_object, const StepContext& context, const RandomStream& random);

// Takes a mode to its minimum: as move_particle, but the view is cast anew every `rounds_per_view` rounds, pairs are
// projective, and the noise added to the sensor's shrinks from round to round.
RefinedMode refine_mode(const Pose& camera_from_object, const StepContext& context, const RefinementOptions& options);

// The pixel cost's options by which refined poses are compared.
PixelCostOptions refined_cost_options(const StepContext& context, const RefinementOptions& options);

// The pixel cost by which refined poses are compared, with its counts.
PixelCost refined_cost(const Pose& camera_from_object, const StepContext& context, const RefinementOptions& options);

}  // namespace nearpose
