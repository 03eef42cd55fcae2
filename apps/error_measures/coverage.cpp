#include "apps/error_measures/coverage.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace nearpose::evaluation {
namespace {

void count(const FrameErrors& frame, Coverage& coverage) {
    if (!frame.errors || !frame.errors->mahalanobis_squared) return;
    ++coverage.frames;
    const double probability = chi_square_of_6(*frame.errors->mahalanobis_squared);
    for (std::size_t level = 0; level < kCoverageLevels.size(); ++level) {
        if (probability <= kCoverageLevels[level]) ++coverage.inside[level];
    }
}

bool is_placed(const FrameErrors& frame) {
    return frame.errors && frame.errors->mahalanobis_squared && frame.visibility &&
           std::isfinite(frame.visibility->distance_m);
}

// In which bin of that width; values that rounding left a hair below a border lie above it.
double bin_of(double distance_mm, double width_mm) {
    return std::floor(distance_mm / width_mm + 1e-9);
}

double bin_width_mm(double low_mm, double high_mm) {
    constexpr double kMostBins = 8.0;
    for (double power = 1.0; power < 1e12; power *= 10.0) {
        for (const double factor : {1.0, 2.0, 5.0}) {
            const double width_mm = factor * power;
            if (bin_of(high_mm, width_mm) - bin_of(low_mm, width_mm) + 1.0 <= kMostBins) return width_mm;
        }
    }
    return 1e12;
}

}  // namespace

double Coverage::share(std::size_t level) const {
    return frames > 0 ? static_cast<double>(inside.at(level)) / frames : 0.0;
}

double chi_square_of_6(double squared) {
    const double half = 0.5 * squared;
    return 1.0 - std::exp(-half) * (1.0 + half + 0.5 * half * half);
}

Coverage coverage_of(const std::vector<FrameErrors>& frames) {
    Coverage coverage;
    for (const FrameErrors& frame : frames) count(frame, coverage);
    return coverage;
}

std::vector<CoverageBin> coverage_by_distance(const std::vector<FrameErrors>& frames) {
    double low_mm = std::numeric_limits<double>::infinity(), high_mm = -low_mm;
    for (const FrameErrors& frame : frames) {
        if (!is_placed(frame)) continue;
        low_mm = std::min(low_mm, 1e3 * frame.visibility->distance_m);
        high_mm = std::max(high_mm, 1e3 * frame.visibility->distance_m);
    }
    if (!(low_mm <= high_mm)) return {};
    const double width_mm = bin_width_mm(low_mm, high_mm);
    std::map<double, Coverage> of_bin;
    for (const FrameErrors& frame : frames) {
        if (is_placed(frame)) count(frame, of_bin[bin_of(1e3 * frame.visibility->distance_m, width_mm)]);
    }
    std::vector<CoverageBin> bins;
    for (const auto& [bin, coverage] : of_bin) {
        bins.push_back({1e-3 * bin * width_mm, 1e-3 * (bin + 1.0) * width_mm, coverage});
    }
    return bins;
}

}  // namespace nearpose::evaluation
