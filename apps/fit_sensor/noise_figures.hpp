// Figures of axial noise from its sigma at several depths and angles, and of how far neighbours share it.
#pragma once

#include <span>
#include <vector>

#include "apps/fit_sensor/sensor_fit.hpp"

namespace nearpose::simulate {

// Autocorrelation at `lag` pixels, along a row, of white noise smoothed with a Gaussian of `correlation_pixels` (as
// correlated_noise does it).
double shared_noise(double correlation_pixels, int lag);

// The correlation_pixels whose mean autocorrelation at the lags 1..kLags is the given one.
inline constexpr int kLags = 3;
double correlation_for(double mean_autocorrelation);

// By how much the variance of a mean of squares grows because pixels share noise: the sum of the squared
// autocorrelation over all lags in u and v.
double variance_growth(double correlation_pixels);

// Which of the three figures are to be fitted; the others stay.
struct FreeFigures {
    bool floor = true, per_square_metre = true, angle_factor = true;
};

struct AxialFigures {
    FittedFigure floor_m, per_square_metre, angle_factor;
    double misfit = 0.0;
};

// Weighted least squares of the cells' sigma, none of the figures negative. Starts from `base`.
AxialFigures fit_axial_figures(std::span<const NoiseCell> cells, const SensorNoise& base, const FreeFigures& free);

// The sigma of a cell by these figures, with what is not axial.
double cell_sigma_m(const NoiseCell& cell, double floor_m, double per_square_metre, double angle_factor);

}  // namespace nearpose::simulate
