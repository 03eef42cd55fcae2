#include "apps/evaluate/error_curves.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "apps/base/number_text.hpp"
#include "apps/error_measures/coverage.hpp"
#include "apps/error_measures/run_summary.hpp"

namespace nearpose::evaluation {
namespace {

constexpr int kBins = 12;

// What errors are drawn against.
struct Abscissa {
    const char* title;
    bool logarithmic;
    std::function<std::optional<double>(const Visibility&)> value;
};

std::vector<Abscissa> abscissas() {
    return {{"distance of the visible points [mm]", false,
             [](const Visibility& visibility) { return 1e3 * visibility.distance_m; }},
            {"volume of the visible points' ellipsoid [cm^3]", true,
             [](const Visibility& visibility) -> std::optional<double> {
                 if (!(visibility.visible_volume_m3 > 0.0)) return std::nullopt;  // a flat set has none
                 return 1e6 * visibility.visible_volume_m3;
             }},
            {"visible fraction of the silhouette", false,
             [](const Visibility& visibility) { return visibility.visible_fraction; }}};
}

pictures::CurvePlot plot_of(const std::vector<FrameErrors>& frames, const Abscissa& abscissa, double units,
                            double PoseErrors::*error, const std::string& quantity) {
    std::vector<CurvePoint> points;
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const FrameErrors& frame : frames) {
        if (!frame.errors || !frame.visibility) continue;
        const std::optional<double> x = abscissa.value(*frame.visibility);
        if (!x) continue;
        points.push_back({*x, units * *frame.errors.*error});
        low = std::min(low, *x);
        high = std::max(high, *x);
    }
    pictures::CurvePlot plot;
    if (points.empty()) return plot;
    if (!(high > low)) high = low + std::max(1e-3, 1e-3 * low);  // all at one place
    plot.title = quantity.substr(0, quantity.find(" [")) + " against " + abscissa.title;
    plot.title = plot.title.substr(0, plot.title.find(" ["));
    plot.x_title = abscissa.title;
    plot.y_title = quantity;
    plot.x_logarithmic = abscissa.logarithmic;
    plot.curves = {curve_of("median", points, low, high, kBins, abscissa.logarithmic)};
    return plot;
}

// Share of `probabilities` up to p, for p in (0, 1]; with its confidence interval where `with_band`.
Curve shares_below(const std::string& label, const std::vector<double>& probabilities, bool with_band) {
    constexpr int kSteps = 40;
    Curve curve{label + " (" + std::to_string(probabilities.size()) + ")", {}};
    const int count = static_cast<int>(probabilities.size());
    for (int step = 0; step <= kSteps; ++step) {
        const double p = static_cast<double>(step) / kSteps;
        const auto inside = std::count_if(probabilities.begin(), probabilities.end(),
                                          [&](double probability) { return probability <= p; });
        const Interval share = proportion(static_cast<int>(inside), count);
        curve.bins.push_back({p, count, share.value, with_band ? share.low : share.value,
                              with_band ? share.high : share.value, share.high});
    }
    return curve;
}

// Share of the frames inside the region of one level, over the middles of the bins; the band of 90 % is its interval.
Curve coverage_curve(const std::vector<CoverageBin>& bins, std::size_t level) {
    const double probability = kCoverageLevels.at(level);
    Curve curve{data_set::format_number(100.0 * probability) + " % region", {}};
    for (const CoverageBin& bin : bins) {
        const int frames = bin.coverage.frames;
        const Interval share = proportion(bin.coverage.inside.at(level), frames);
        const bool with_band = probability == 0.9;
        curve.bins.push_back({1e3 * 0.5 * (bin.from_m + bin.to_m), frames, share.value,
                              with_band ? share.low : share.value, with_band ? share.high : share.value, share.high});
    }
    return curve;
}

pictures::CurvePlot coverage_plot(const std::vector<CoverageBin>& bins) {
    constexpr std::array<std::size_t, 3> kOrder = {1, 0, 2};  // 90 % first: its colour and band stand out
    static_assert(kOrder.size() == kCoverageLevels.size());
    pictures::CurvePlot plot;
    plot.title = "share of the frames with the truth inside the region, by distance";
    plot.x_title = abscissas().front().title;
    plot.y_title = "share of the frames";
    plot.y_is_share = true;
    plot.target = {kLeastCoverageOf90, kMostCoverageOf90, "aim of the 90 % region: 85 to 95 %"};
    for (const std::size_t level : kOrder) {
        plot.curves.push_back(coverage_curve(bins, level));
        plot.nominal.push_back(kCoverageLevels.at(level));
    }
    return plot;
}

}  // namespace

std::vector<pictures::CurvePlot> error_curves(const std::vector<FrameErrors>& frames) {
    std::vector<pictures::CurvePlot> plots;
    for (const Abscissa& abscissa : abscissas()) {
        for (const pictures::CurvePlot& plot :
             {plot_of(frames, abscissa, 1e3, &PoseErrors::translation_m, "translation error [mm]"),
              plot_of(frames, abscissa, 180.0 / std::numbers::pi, &PoseErrors::rotation_rad, "rotation error [deg]")}) {
            if (!plot.curves.empty()) plots.push_back(plot);
        }
    }
    return plots;
}

std::vector<pictures::CurvePlot> calibration_curves(const std::vector<FrameErrors>& frames) {
    struct Band {
        const char* label;
        double low_m, high_m;
    };
    constexpr double kFar = std::numeric_limits<double>::infinity();
    constexpr Band kBands[] = {{"under 250 mm", 0.0, 0.25}, {"250 to 400 mm", 0.25, 0.4}, {"over 400 mm", 0.4, kFar}};
    const auto probabilities = [&](double low_m, double high_m, bool all) {
        std::vector<double> values;
        for (const FrameErrors& frame : frames) {
            if (!frame.errors || !frame.errors->mahalanobis_squared) continue;
            const double distance_m = frame.visibility ? frame.visibility->distance_m : -1.0;
            if (!all && !(distance_m >= low_m && distance_m < high_m)) continue;
            values.push_back(chi_square_of_6(*frame.errors->mahalanobis_squared));
        }
        return values;
    };
    const std::vector<double> of_all = probabilities(0.0, kFar, true);
    if (of_all.empty()) return {};
    pictures::CurvePlot plot;
    plot.title = "share of the frames with the truth inside the p-region";
    plot.x_title = "p";
    plot.y_title = "share of the frames";
    plot.is_share_of_share = true;
    plot.curves.push_back(shares_below("all frames", of_all, true));
    for (const Band& band : kBands) {
        const std::vector<double> of_band = probabilities(band.low_m, band.high_m, false);
        if (!of_band.empty()) plot.curves.push_back(shares_below(band.label, of_band, false));
    }
    const std::vector<CoverageBin> bins = coverage_by_distance(frames);
    if (bins.empty()) return {plot};
    return {plot, coverage_plot(bins)};
}

}  // namespace nearpose::evaluation
