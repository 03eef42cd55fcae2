// A plot's axis: where values lie, and which are labelled.
#pragma once

#include <string>
#include <vector>

namespace nearpose::pictures {

struct Axis {
    double low = 0.0, high = 1.0;  // values at the ends; low < high, and low > 0 where logarithmic
    bool logarithmic = false;
    std::vector<double> ticks;  // ascending, within the ends

    double fraction(double value) const;  // 0 at low, 1 at high; values outside are moved to the ends
    static std::string label(double tick);
};

// About `num_ticks` round numbers; ends at the first and last value.
Axis frame_axis(double first, double last, int num_ticks);
// From `low` to `high`, moved outwards to round numbers; low < high.
Axis round_axis(double low, double high, int num_ticks);
// Logarithmic, from a little below `low` to a little above `high`, with round ticks; 0 < low <= high.
Axis ratio_axis(double low, double high);
// For values >= 0: from 0, or logarithmic where they span more than a factor of 30. Ends are round numbers.
Axis error_axis(const std::vector<double>& values);

}  // namespace nearpose::pictures
