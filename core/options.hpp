// All options of the estimator.
#pragma once

#include <cstdint>

#include "core/evidence/verdict.hpp"
#include "core/fit/track.hpp"
#include "core/method.hpp"
#include "core/shape/symmetry.hpp"

namespace nearpose {

struct EstimatorOptions {
    Method method = method_default();
    int num_particles = 200;
    int num_threads = 0;  // 0: as many as the machine has
    std::uint64_t seed = 1;
    int min_candidates = 50;   // pixels; fewer show nothing of the object
    Symmetries symmetries;     // of the part
    Tolerance tolerance;       // of the verdict
    MotionNoise motion_noise;  // of the arm
    // Elapsed time for an update [s]; 0: as long as it takes. Particles, alternatives, modes and search candidates are
    // left out to keep within it, and results then depend on the machine's speed.
    double budget_s = 0.0;
};

// Throws std::invalid_argument naming field, value and bound.
void validate(const EstimatorOptions& options);

}  // namespace nearpose
