#include "apps/pictures/axis.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace nearpose::pictures {
namespace {

// The smallest of 1, 2, 5 times a power of ten that is not below `value`.
double round_up(double value) {
    const double power = std::pow(10.0, std::floor(std::log10(value)));
    for (const double factor : {1.0, 2.0, 5.0, 10.0}) {
        if (factor * power >= value * (1.0 - 1e-9)) return factor * power;
    }
    return 10.0 * power;
}

Axis logarithmic_axis(double smallest, double largest) {
    Axis axis;
    axis.logarithmic = true;
    axis.low = 1.0 / round_up(1.0 / smallest);
    axis.high = round_up(largest);
    const bool few_decades = axis.high / axis.low <= 1000.0;
    for (int exponent = static_cast<int>(std::floor(std::log10(axis.low) + 1e-9));
         std::pow(10.0, exponent) <= axis.high * 1.0001; ++exponent) {
        for (const double factor : {1.0, 2.0, 5.0}) {
            const double tick = factor * std::pow(10.0, exponent);
            const bool inside = tick >= axis.low * 0.9999 && tick <= axis.high * 1.0001;
            if (inside && (factor == 1.0 || few_decades)) axis.ticks.push_back(tick);
        }
    }
    return axis;
}

}  // namespace

double Axis::fraction(double value) const {
    const double bounded = std::clamp(value, low, high);
    return logarithmic ? std::log(bounded / low) / std::log(high / low) : (bounded - low) / (high - low);
}

std::string Axis::label(double tick) {
    // Ticks are round: six digits drop what the product with a power of ten left behind.
    std::array<char, 32> text{};
    const auto [end, error] =
        std::to_chars(text.data(), text.data() + text.size(), tick, std::chars_format::general, 6);
    return {text.data(), error == std::errc() ? end : text.data()};
}

Axis frame_axis(double first, double last, int num_ticks) {
    Axis axis;
    axis.low = first;
    axis.high = std::max(last, first + 1.0);
    const double step = std::max(1.0, round_up((axis.high - axis.low) / num_ticks));
    for (double tick = std::ceil(axis.low / step) * step; tick <= axis.high; tick += step) axis.ticks.push_back(tick);
    return axis;
}

Axis round_axis(double low, double high, int num_ticks) {
    const double step = round_up((high - low) / num_ticks);
    const double first = std::floor(low / step + 1e-9), last = std::ceil(high / step - 1e-9);
    Axis axis;
    axis.low = first * step;
    axis.high = last * step;
    for (double i = first; i <= last; ++i) axis.ticks.push_back(i * step);
    return axis;
}

Axis ratio_axis(double low, double high) {
    // Round ends would leave much of the axis empty where values span little; the finest ticks that do not crowd.
    constexpr double kMargin = 1.05;
    constexpr std::size_t kMostTicks = 9;
    Axis axis{low / kMargin, high * kMargin, true, {}};
    for (const std::vector<double>& factors :
         {std::vector<double>{1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0}, {1.0, 2.0, 5.0}, {1.0}}) {
        axis.ticks.clear();
        for (double exponent = std::floor(std::log10(axis.low)); exponent <= std::log10(axis.high); ++exponent) {
            for (const double factor : factors) {
                const double tick = factor * std::pow(10.0, exponent);
                if (tick >= axis.low && tick <= axis.high) axis.ticks.push_back(tick);
            }
        }
        if (axis.ticks.size() <= kMostTicks) break;
    }
    return axis;
}

Axis error_axis(const std::vector<double>& values) {
    constexpr double kSpan = 30.0;
    double smallest = 1e300, largest = 0.0;
    for (const double value : values) {
        if (value > 0.0) smallest = std::min(smallest, value);
        largest = std::max(largest, value);
    }
    if (largest <= 0.0) return {0.0, 1.0, false, {0.0, 0.5, 1.0}};
    if (largest / smallest > kSpan) return logarithmic_axis(std::max(smallest, 1e-5 * largest), largest);
    const double step = round_up(largest / 5.0);
    Axis axis;
    const int num_steps = static_cast<int>(std::ceil(largest / step * (1.0 - 1e-9)));
    axis.high = num_steps * step;
    for (int i = 0; i <= num_steps; ++i) axis.ticks.push_back(i * step);
    return axis;
}

}  // namespace nearpose::pictures
