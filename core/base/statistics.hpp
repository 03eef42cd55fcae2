// Quantiles of the usual distributions, with their sources, and the median.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace nearpose {

// What a chi-square variable with 6 degrees of freedom exceeds once in a thousand times (Abramowitz and Stegun 1964,
// table 26.8).
inline constexpr double kChiSquare6_999 = 22.46;

// Radius of the ball, in sigmas, that holds 90 % of a normal distribution in three dimensions: the root of the 90 %
// quantile of chi-square with 3 degrees of freedom, 6.2514 (the same table).
inline constexpr double kNormalRadius3_90 = 2.5003;

// Median of |x| for a standard normal x, its 75 % quantile. A median of absolute values divided by it estimates the
// standard deviation (Rousseeuw and Croux 1993).
inline constexpr double kMedianOfAbsoluteNormal = 0.6745;

// The value in the middle, the upper one of two. `values` must not be empty.
template <typename Value>
Value median(std::vector<Value> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

}  // namespace nearpose
