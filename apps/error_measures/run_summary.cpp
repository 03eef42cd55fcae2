#include "apps/error_measures/run_summary.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <stdexcept>

#include "apps/base/degrees.hpp"
#include "apps/error_measures/interruptions.hpp"
#include "core/base/random.hpp"

namespace nearpose::evaluation {
namespace {

constexpr double kMillimetres = 1e3;
constexpr double kNormal975 = 1.9599639845400545;  // quantile of the normal distribution

// The streams of this module beside the estimator's and the simulation's own.
constexpr auto kBootstrapDraw = static_cast<RandomPurpose>(200);

using Frames = std::vector<FrameErrors>;

// Errors of the frames that have a pose.
template <typename Value>
Statistics statistics_over(const Frames& frames, const Value& value) {
    std::vector<double> values;
    for (const FrameErrors& frame : frames) {
        if (frame.errors) values.push_back(value(*frame.errors));
    }
    return statistics_of(std::move(values));
}

// The share of frames whose error is below a threshold, averaged over thresholds from 0 to `largest_m`: a frame with
// error e is below them from e on, so it gives 1 - e / largest. Frames without a pose give nothing.
double area_under_recall(const Frames& frames, double PoseErrors::*error_m, double largest_m) {
    if (frames.empty() || !(largest_m > 0.0)) return 0.0;
    double sum = 0.0;
    for (const FrameErrors& frame : frames) {
        if (frame.errors) sum += std::max(0.0, 1.0 - *frame.errors.*error_m / largest_m);
    }
    return sum / static_cast<double>(frames.size());
}

std::optional<double> share_inside(const Frames& frames, std::optional<double> PoseErrors::*squared, double quantile) {
    int known = 0, inside = 0;
    for (const FrameErrors& frame : frames) {
        if (!frame.errors || !(*frame.errors.*squared)) continue;
        ++known;
        if (*(*frame.errors.*squared) <= quantile) ++inside;
    }
    if (known == 0) return std::nullopt;
    return static_cast<double>(inside) / known;
}

void count_frames(const Frames& frames, const ErrorLimit& coarse, RunSummary& summary) {
    summary.frames = static_cast<int>(frames.size());
    const std::vector<bool> excused = excused_frames(frames);
    bool arrived = false;
    for (std::size_t i = 0; i < frames.size(); ++i) {
        const FrameErrors& frame = frames[i];
        if (!frame.errors) ++summary.frames_without_pose;
        if (frame.predicted) ++summary.frames_predicted;
        if (frame.shown == Shown::kPart) ++summary.frames_shown;
        if (arrived && !excused[i]) {
            ++summary.frames_after_arrival;
            if (!within(frame, coarse)) ++summary.frames_lost;
        }
        arrived = arrived || (frame.shown == Shown::kPart && within(frame, coarse));
    }
}

// Whether what holds in the end has held since the burn-in, but for excused frames.
bool held_since(int burn_in, const Arrival& arrival, const std::vector<bool>& excused) {
    if (!arrival.holds_from) return false;
    auto from = static_cast<std::size_t>(*arrival.holds_from);
    while (from > 0 && excused[from - 1]) --from;
    return static_cast<int>(from) <= burn_in;
}

std::optional<int> frames_to_refind(const Frames& frames, const ErrorLimit& coarse) {
    const std::optional<int> returned = return_index(frames);
    for (int i = returned.value_or(0); returned && i < static_cast<int>(frames.size()); ++i) {
        const FrameErrors& frame = frames[static_cast<std::size_t>(i)];
        if (frame.shown == Shown::kPart && within(frame, coarse)) return i - *returned + 1;
    }
    return std::nullopt;
}

void summarise_errors(const Frames& frames, double model_diameter_m, RunSummary& summary) {
    const auto in_mm = [&](double PoseErrors::*error_m) {
        return statistics_over(frames, [&](const PoseErrors& errors) { return kMillimetres * (errors.*error_m); });
    };
    summary.translation_mm = in_mm(&PoseErrors::translation_m);
    summary.add_mm = in_mm(&PoseErrors::add_m);
    summary.add_s_mm = in_mm(&PoseErrors::add_s_m);
    summary.mssd_mm = in_mm(&PoseErrors::mssd_m);
    summary.mspd_px = statistics_over(frames, [](const PoseErrors& errors) { return errors.mspd_px; });
    summary.rotation_deg =
        statistics_over(frames, [](const PoseErrors& errors) { return kDegrees * errors.rotation_rad; });
    for (int axis = 0; axis < 3; ++axis) {
        summary.translation_axis_mm[axis] = statistics_over(frames, [axis](const PoseErrors& errors) {
            return kMillimetres * std::abs(errors.translation_in_camera_m[axis]);
        });
        summary.rotation_axis_deg[axis] = statistics_over(frames, [axis](const PoseErrors& errors) {
            return kDegrees * std::abs(errors.rotation_in_camera_rad[axis]);
        });
    }
    summary.depth_mm = statistics_over(
        frames, [](const PoseErrors& errors) { return kMillimetres * errors.translation_in_camera_m.z(); });
    constexpr double kLargest_m = 0.1, kLargestOfDiameter = 0.1;
    summary.add_auc = area_under_recall(frames, &PoseErrors::add_m, kLargest_m);
    summary.add_s_auc = area_under_recall(frames, &PoseErrors::add_s_m, kLargest_m);
    summary.add_auc_diameter = area_under_recall(frames, &PoseErrors::add_m, kLargestOfDiameter * model_diameter_m);
    summary.add_s_auc_diameter = area_under_recall(frames, &PoseErrors::add_s_m, kLargestOfDiameter * model_diameter_m);
}

void summarise_covariances(const Frames& frames, RunSummary& summary) {
    for (const FrameErrors& frame : frames) {
        if (frame.errors && frame.errors->mahalanobis_squared) ++summary.frames_with_covariance;
    }
    summary.coverage = coverage_of(frames);
    summary.coverage_by_distance = coverage_by_distance(frames);
    summary.inside_90 = share_inside(frames, &PoseErrors::mahalanobis_squared, kChiSquare90Of6);
    summary.inside_90_rotation = share_inside(frames, &PoseErrors::mahalanobis_rotation_squared, kChiSquare90Of3);
    summary.inside_90_translation = share_inside(frames, &PoseErrors::mahalanobis_translation_squared, kChiSquare90Of3);
}

double mean_of(const std::vector<double>& values) {
    double sum = 0.0;
    for (const double value : values) sum += value;
    return sum / static_cast<double>(values.size());
}

}  // namespace

double percentile(const std::vector<double>& ascending, double fraction) {
    const double rank = fraction * static_cast<double>(ascending.size() - 1);
    const auto below = static_cast<std::size_t>(rank);
    const std::size_t above = std::min(below + 1, ascending.size() - 1);
    return std::lerp(ascending[below], ascending[above], rank - static_cast<double>(below));
}

Statistics statistics_of(std::vector<double> values) {
    if (values.empty()) return {};
    std::sort(values.begin(), values.end());
    Statistics statistics;
    statistics.count = values.size();
    statistics.mean = mean_of(values);
    double squares = 0.0;
    for (const double value : values) squares += (value - statistics.mean) * (value - statistics.mean);
    if (values.size() > 1) {
        statistics.standard_deviation = std::sqrt(squares / static_cast<double>(values.size() - 1));
    }
    statistics.median = percentile(values, 0.5);
    statistics.percentile_95 = percentile(values, 0.95);
    statistics.max = values.back();
    return statistics;
}

bool within(const FrameErrors& frame, const ErrorLimit& limit) {
    return frame.errors && frame.errors->translation_m <= limit.translation_m &&
           frame.errors->rotation_rad <= limit.rotation_rad;
}

Arrival arrival_of(const std::vector<FrameErrors>& frames, const ErrorLimit& limit) {
    Arrival arrival;
    const std::vector<bool> excused = excused_frames(frames);
    for (int i = 0; i < static_cast<int>(frames.size()); ++i) {
        const auto index = static_cast<std::size_t>(i);
        if (frames[index].shown != Shown::kPart) continue;
        if (!within(frames[index], limit)) {
            if (!excused[index]) arrival.holds_from.reset();
            continue;
        }
        if (!arrival.first_index) arrival.first_index = i;
        if (!arrival.holds_from) arrival.holds_from = i;
    }
    return arrival;
}

RunSummary summarise(const std::vector<FrameErrors>& frames, double model_diameter_m, const SummaryOptions& options) {
    RunSummary summary;
    count_frames(frames, options.coarse, summary);
    summary.coarse = arrival_of(frames, options.coarse);
    summary.fine = arrival_of(frames, options.fine);
    const auto burn_in = std::clamp<std::ptrdiff_t>(options.burn_in, 0, static_cast<std::ptrdiff_t>(frames.size()));
    summary.held = held_since(options.burn_in, summary.coarse, excused_frames(frames));
    summary.frames_to_refind = frames_to_refind(frames, options.coarse);
    summary.verdicts = count_verdicts(frames, options.tolerance);
    Frames settled;
    std::copy_if(frames.begin() + burn_in, frames.end(), std::back_inserter(settled),
                 [](const FrameErrors& frame) { return frame.shown == Shown::kPart; });
    summarise_errors(settled, model_diameter_m, summary);
    summarise_covariances(settled, summary);
    std::vector<double> times_ms;
    for (const FrameErrors& frame : frames) {
        if (frame.time_s >= 0.0) times_ms.push_back(1e3 * frame.time_s);
    }
    summary.time_ms = statistics_of(std::move(times_ms));
    return summary;
}

Interval proportion(int successes, int trials) {
    if (trials < 1 || successes < 0 || successes > trials) {
        throw std::invalid_argument("a proportion of " + std::to_string(successes) + " out of " +
                                    std::to_string(trials));
    }
    const double n = trials, share = successes / n, z2 = kNormal975 * kNormal975;
    const double middle = (share + z2 / (2.0 * n)) / (1.0 + z2 / n);
    const double half = kNormal975 / (1.0 + z2 / n) * std::sqrt(share * (1.0 - share) / n + z2 / (4.0 * n * n));
    // The ends of all and of none are 1 and 0 but for rounding.
    return {share, successes == 0 ? 0.0 : middle - half, successes == trials ? 1.0 : middle + half};
}

Interval mean_over_runs(const std::vector<double>& value_of_run) {
    if (value_of_run.empty()) throw std::invalid_argument("a mean over no runs");
    constexpr std::uint64_t kSeed = 1;
    constexpr int kResamples = 2000;
    std::vector<double> means;
    for (int resample = 0; resample < kResamples; ++resample) {
        RandomStream random(kSeed, static_cast<std::uint64_t>(resample), 0, kBootstrapDraw);
        std::vector<double> drawn;
        for (std::size_t i = 0; i < value_of_run.size(); ++i) {
            drawn.push_back(
                value_of_run[static_cast<std::size_t>(random.below(static_cast<int>(value_of_run.size())))]);
        }
        means.push_back(mean_of(drawn));
    }
    std::sort(means.begin(), means.end());
    return {mean_of(value_of_run), percentile(means, 0.025), percentile(means, 0.975)};
}

}  // namespace nearpose::evaluation
