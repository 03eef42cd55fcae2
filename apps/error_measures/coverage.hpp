// Whether covariances can be believed, by how far the part is away: how often the truth lies in the region that should
// hold it with a given probability.
#pragma once

#include <array>
#include <vector>

#include "apps/error_measures/frame_errors.hpp"

namespace nearpose::evaluation {

// The probabilities of the regions.
inline constexpr std::array kCoverageLevels = {0.5, 0.9, 0.99};
// A 90 % region that holds the truth in this share of the frames is neither too small nor uselessly large.
inline constexpr double kLeastCoverageOf90 = 0.85, kMostCoverageOf90 = 0.95;

struct Coverage {
    int frames = 0;                                       // with a covariance
    std::array<int, kCoverageLevels.size()> inside = {};  // of them: truth inside the region, by level
    double share(std::size_t level) const;                // of the frames, in 0..1; 0 without a frame
};

struct CoverageBin {
    double from_m = 0.0, to_m = 0.0;  // distance of the visible points' mean (Visibility) in [from, to)
    Coverage coverage;
};

// Coverage over all frames, whether their distance is known or not.
Coverage coverage_of(const std::vector<FrameErrors>& frames);

// By distance, ascending: bins of one round width (1, 2 or 5 times a power of ten, at least 1 mm), the least of which
// eight suffice. Frames whose distance is not known are in none, bins without a frame are left out.
std::vector<CoverageBin> coverage_by_distance(const std::vector<FrameErrors>& frames);

// The chance that chi-square of 6 degrees of freedom is below `squared`.
double chi_square_of_6(double squared);

}  // namespace nearpose::evaluation
