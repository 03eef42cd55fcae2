// Many frames, few numbers.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/error_measures/coverage.hpp"
#include "apps/error_measures/frame_errors.hpp"
#include "apps/error_measures/verdict_counts.hpp"

namespace nearpose::evaluation {

struct Statistics {
    std::size_t count = 0;
    double mean = 0.0, standard_deviation = 0.0, median = 0.0, percentile_95 = 0.0, max = 0.0;
};
// All 0 for no values. The deviation is that of a sample (n - 1).
Statistics statistics_of(std::vector<double> values);
// Of values in ascending order, at least one; interpolates between those of neighbouring ranks.
double percentile(const std::vector<double>& ascending, double fraction);

struct ErrorLimit {
    double translation_m = 0.010;
    double rotation_rad = 0.0872664625997164788;  // 5 degrees
};

// First within a limit, and from when on for good. Frames that do not show the part count for neither, and a pose that
// is not there in an excused frame (interruptions.hpp) does not end what holds.
struct Arrival {
    std::optional<int> first_index;  // into the frames; nothing: never
    std::optional<int> holds_from;   // nothing: the last frame that counts is not within it
    bool stays() const { return first_index && holds_from && *first_index == *holds_from; }
};
bool within(const FrameErrors& frame, const ErrorLimit& limit);  // false without a pose
Arrival arrival_of(const std::vector<FrameErrors>& frames, const ErrorLimit& limit);

// Squared distances that bound the 90 % region of a normal distribution: quantiles of chi-square.
inline constexpr double kChiSquare90Of6 = 10.644640675668420;
inline constexpr double kChiSquare90Of3 = 6.2513886311703235;

struct SummaryOptions {
    int burn_in = 15;                               // frames at the beginning that the error statistics leave out
    ErrorLimit coarse;                              // 10 mm, 5 degrees
    ErrorLimit fine{0.002, 0.0174532925199432958};  // 2 mm, 1 degree
    Tolerance tolerance = {};                       // of accepted poses
};

// Of one run. Errors are of the frames after the burn-in that show the part and have a pose.
struct RunSummary {
    int frames = 0, frames_without_pose = 0, frames_predicted = 0;
    int frames_shown = 0;          // that show the part
    int frames_after_arrival = 0;  // after the first arrival, but for the excused ones (interruptions.hpp)
    int frames_lost = 0;           // of these: not within the coarse limit
    bool held = false;             // within the coarse limit in all frames after the burn-in, but for the excused ones
    std::optional<int> frames_to_refind;  // from the return (interruptions.hpp) to the coarse limit, both included
    VerdictCounts verdicts;
    Statistics translation_mm, rotation_deg;
    Statistics translation_axis_mm[3], rotation_axis_deg[3];  // absolute values along the camera's x, y, z
    Statistics depth_mm;                                      // estimate - truth along the camera's z, with its sign
    Statistics add_mm, add_s_mm, mssd_mm, mspd_px;
    double add_auc = 0.0,
           add_s_auc = 0.0;  // area under the recall curve of 0..100 mm, in 0..1, all frames after burn-in
    double add_auc_diameter = 0.0, add_s_auc_diameter = 0.0;  // of 0..0.1 diameters
    Arrival coarse, fine;
    // Share of the frames with a covariance in which the truth lies inside its 90 % region; nothing: none has one.
    std::optional<double> inside_90;
    std::optional<double> inside_90_rotation, inside_90_translation;  // the same of either part
    int frames_with_covariance = 0;                                   // that these are shares of
    Coverage coverage;                              // of the same frames: the regions of 50, 90 and 99 %
    std::vector<CoverageBin> coverage_by_distance;  // of those of them whose distance is known
    Statistics time_ms;
};
RunSummary summarise(const std::vector<FrameErrors>& frames, double model_diameter_m, const SummaryOptions& options);

// An estimate with its 95 % confidence interval.
struct Interval {
    double value = 0.0, low = 0.0, high = 0.0;
};
// Throw std::invalid_argument for no trial and no run.
// Wilson's interval of `successes` out of `trials` (at least one).
Interval proportion(int successes, int trials);
// Mean over independent runs: percentile bootstrap of 2000 resamples of the runs, from a fixed seed.
Interval mean_over_runs(const std::vector<double>& value_of_run);

}  // namespace nearpose::evaluation
