// Errors against what they depend on: values in bins of another quantity.
#pragma once

#include <string>
#include <vector>

namespace nearpose::evaluation {

struct CurveBin {
    double x = 0.0;  // middle of the bin
    int count = 0;   // of values in it; empty bins are left out
    double median = 0.0, percentile_25 = 0.0, percentile_75 = 0.0, percentile_95 = 0.0;
};

struct Curve {
    std::string label;
    std::vector<CurveBin> bins;  // ascending x
};

struct CurvePoint {
    double x = 0.0, y = 0.0;
};

// Bins of equal width between `low` and `high`; points outside are left out. With `logarithmic`, of equal ratio.
Curve curve_of(const std::string& label, const std::vector<CurvePoint>& points, double low, double high, int num_bins,
               bool logarithmic = false);

}  // namespace nearpose::evaluation
