#include "apps/error_measures/curve.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "apps/error_measures/run_summary.hpp"

namespace nearpose::evaluation {

Curve curve_of(const std::string& label, const std::vector<CurvePoint>& points, double low, double high, int num_bins,
               bool logarithmic) {
    if (num_bins < 1 || !(low < high) || (logarithmic && !(low > 0.0))) {
        throw std::invalid_argument("the bins of a curve must lie between a low and a higher value" +
                                    std::string(logarithmic ? ", both above 0" : ""));
    }
    const auto place = [&](double x) {
        return logarithmic ? std::log(x / low) / std::log(high / low) : (x - low) / (high - low);
    };
    const auto value = [&](double at) {
        return logarithmic ? low * std::pow(high / low, at) : std::lerp(low, high, at);
    };
    std::vector<std::vector<double>> values(static_cast<std::size_t>(num_bins));
    for (const CurvePoint& point : points) {
        if (!(point.x >= low && point.x <= high) || !std::isfinite(point.y)) continue;
        const int bin = std::clamp(static_cast<int>(place(point.x) * num_bins), 0, num_bins - 1);
        values[static_cast<std::size_t>(bin)].push_back(point.y);
    }
    Curve curve{label, {}};
    for (int bin = 0; bin < num_bins; ++bin) {
        std::vector<double>& of_bin = values[static_cast<std::size_t>(bin)];
        if (of_bin.empty()) continue;
        std::sort(of_bin.begin(), of_bin.end());
        curve.bins.push_back({value((bin + 0.5) / num_bins), static_cast<int>(of_bin.size()), percentile(of_bin, 0.5),
                              percentile(of_bin, 0.25), percentile(of_bin, 0.75), percentile(of_bin, 0.95)});
    }
    return curve;
}

}  // namespace nearpose::evaluation
