// What an update of the estimator returns.
#pragma once

#include <vector>

#include "core/evidence/background.hpp"
#include "core/evidence/likelihood.hpp"
#include "core/evidence/observability.hpp"
#include "core/evidence/verdict.hpp"
#include "core/filter/gradient_step.hpp"
#include "core/shape/modes.hpp"
#include "core/world/arm_check.hpp"

namespace nearpose {

enum class UpdateStatus {
    kEstimated,  // from this observation
    kPredicted,  // the observation shows nothing of the object; the pose before, moved by the control, stands in
    kNoPose,     // nothing was seen yet
};

const char* to_string(UpdateStatus status);

struct UpdateSeconds {
    StageSeconds stages;                                                 // summed over threads
    double start = 0.0, particles = 0.0, refinement = 0.0, total = 0.0;  // elapsed
};

// What an update was made with.
struct Effort {
    int starts = 0;  // candidates of a search; 0: none was made
    int particles = 0;
    int alternatives = 0;             // hypotheses beside the modes that were tried
    int modes = 0;                    // refined
    bool reduced_for_budget = false;  // more would have been made with more time
};

struct UpdateResult {
    UpdateStatus status = UpdateStatus::kNoPose;
    Pose camera_from_object;                 // the MAP; meaningless where there is no pose
    Matrix6d covariance = Matrix6d::Zero();  // of the twist of camera_from_object * exp(twist), rotation first
    double cost = 0.0;                       // of the MAP: PixelCost::cost, or epsilon [m^2]
    double score = 0.0;                      // larger is better: 1 - pixel cost, or 1 / (1 + epsilon / sigma^2)
    Verdict verdict = Verdict::kContinue;    // may the pose be acted on?
    std::vector<Shortfall> missing;          // why not; empty where it may
    std::vector<Mode> modes;                 // refined, best first; the default method's
    Observability observability;             // of this frame alone; the tracked pose may be known better
    PixelCost pixels;                        // how the estimate's rays compare with the depth image
    PositiveEvidence positive_evidence;      // what the image shows of the model beyond planes
    double log_odds_present = 0.0;           // that the object is there, with the frames before [nats]
    ArmFindings arm;                         // whether the images move as the arm says
    Effort effort;
    double effective_sample_size = 0.0;  // 1..number of particles, after weighting
    bool resampled = false;              // before this update's propagation
    bool mode_replaced = false;          // another mode explains the observation better than the tracked one
    int points_observed = 0;             // candidate pixels
    StepCounts counts;
    UpdateSeconds seconds;
};

}  // namespace nearpose
