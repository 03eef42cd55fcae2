// Options of global localisation.
#pragma once

#include "core/filter/gradient_step.hpp"

namespace nearpose {

// Where the particles come from at first, and after a loss.
enum class Initialisation {
    kSphere,   // the paper's: viewpoints on a sphere around the centroid of what is seen
    kSurface,  // also single points of the model on measured ones
    kPairs,    // also pairs of points
};

struct SearchOptions {
    Initialisation initialisation = Initialisation::kSphere;
    int candidates = 0;         // poses of which the best become the particles; 0: all of them do
    int least_candidates = 20;  // of a search that the time budget cuts short
    int draws = 10000;  // of kPairs, where the object is segmented: hypotheses drawn and pruned to the candidates
    int draws_factor_unsegmented = 6;  // so many times as many where it is not: most of them miss the object
    GradientStep step;                 // taken by each candidate
};

// Throws std::invalid_argument naming field, value and bound.
void validate(const SearchOptions& options);

}  // namespace nearpose
