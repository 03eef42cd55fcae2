#include "apps/fit_sensor/noise_figures.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>

namespace nearpose::simulate {
namespace {

constexpr double kMaxCorrelation = 20.0;  // [pixels], as in validate(SensorNoise)

struct Equations {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    double chi_square = 0.0;
};

// Errors of the cells' sigma are 1 / sqrt(2 n) of themselves. They are taken from the model, not from the measured
// sigma: cells that came out low by chance would weigh more.
Equations equations_at(std::span<const NoiseCell> cells, const Eigen::Vector3d& x, const Eigen::Vector3d& weighed_at) {
    Equations sum;
    for (const NoiseCell& cell : cells) {
        const double with_depth = x[0] + x[1] * cell.depth_term, with_angle = 1.0 + x[2] * cell.angle_term;
        const double model_m = cell_sigma_m(cell, x[0], x[1], x[2]);
        const double axial_part = with_depth * with_angle / model_m;
        const Eigen::Vector3d slope =
            axial_part * Eigen::Vector3d(with_angle, cell.depth_term * with_angle, with_depth * cell.angle_term);
        const double at_m = cell_sigma_m(cell, weighed_at[0], weighed_at[1], weighed_at[2]);
        const double weight = 2.0 * cell.effective / (at_m * at_m);
        const double residual_m = cell.sigma_m - model_m;
        sum.normal += weight * slope * slope.transpose();
        sum.right += weight * residual_m * slope;
        sum.chi_square += weight * residual_m * residual_m;
    }
    return sum;
}

// One damped step in the free figures; each is scaled by its own curvature. Figures that would become negative are 0.
Eigen::Vector3d stepped(const Equations& at, const Eigen::Vector3d& x, const std::array<bool, 3>& free,
                        double damping) {
    Eigen::Matrix3d normal = at.normal;
    Eigen::Vector3d right = at.right;
    for (int i = 0; i < 3; ++i) {
        // What pulls a figure at 0 further down holds it there.
        const bool held = !free[static_cast<std::size_t>(i)] || (x[i] == 0.0 && at.right[i] <= 0.0);
        if (held || !(normal(i, i) > 0.0)) {
            normal.row(i).setZero();
            normal.col(i).setZero();
            right[i] = 0.0;
            normal(i, i) = 1.0;
        } else {
            normal(i, i) *= 1.0 + damping;
        }
    }
    const Eigen::Vector3d scale = normal.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::Matrix3d scaled = scale.asDiagonal() * normal * scale.asDiagonal();
    const Eigen::Vector3d step = scale.asDiagonal() * scaled.ldlt().solve(scale.asDiagonal() * right);
    return (x + step).cwiseMax(0.0);
}

Eigen::Vector3d least_squares(std::span<const NoiseCell> cells, Eigen::Vector3d x, const std::array<bool, 3>& free) {
    for (int outer = 0; outer < 5; ++outer) {
        const Eigen::Vector3d weighed_at = x;
        double damping = 1e-3;
        for (int i = 0; i < 60 && damping < 1e9; ++i) {
            const Equations here = equations_at(cells, x, weighed_at);
            const Eigen::Vector3d next = stepped(here, x, free, damping);
            const bool better = equations_at(cells, next, weighed_at).chi_square < here.chi_square;
            if (better) x = next;
            damping *= better ? 0.2 : 8.0;
        }
    }
    return x;
}

// Standard deviations of the free figures, from the curvature at the solution.
Eigen::Vector3d deviations(const Equations& at, const std::array<bool, 3>& free) {
    Eigen::Matrix3d normal = at.normal;
    for (int i = 0; i < 3; ++i) {
        if (free[static_cast<std::size_t>(i)] && normal(i, i) > 0.0) continue;
        normal.row(i).setZero();
        normal.col(i).setZero();
        normal(i, i) = 1.0;
    }
    const Eigen::Vector3d scale = normal.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::Matrix3d scaled = scale.asDiagonal() * normal * scale.asDiagonal();
    const Eigen::Matrix3d inverse = scaled.ldlt().solve(Eigen::Matrix3d::Identity());
    return scale.cwiseProduct(inverse.diagonal().cwiseMax(0.0).cwiseSqrt());
}

}  // namespace

double shared_noise(double correlation_pixels, int lag) {
    if (lag == 0) return 1.0;
    if (correlation_pixels <= 0.0) return 0.0;
    const int radius = static_cast<int>(std::ceil(3.0 * correlation_pixels));
    const auto weight = [&](int i) { return std::exp(-0.5 * i * i / (correlation_pixels * correlation_pixels)); };
    double product = 0.0, squares = 0.0;
    for (int i = -radius; i <= radius; ++i) {
        squares += weight(i) * weight(i);
        if (i + lag <= radius) product += weight(i) * weight(i + lag);
    }
    return product / squares;
}

double correlation_for(double mean_autocorrelation) {
    double low = 0.0, high = kMaxCorrelation;
    for (int i = 0; i < 50; ++i) {
        const double middle = 0.5 * (low + high);
        double mean = 0.0;
        for (int lag = 1; lag <= kLags; ++lag) mean += shared_noise(middle, lag) / kLags;
        (mean < mean_autocorrelation ? low : high) = middle;
    }
    return 0.5 * (low + high);
}

double variance_growth(double correlation_pixels) {
    double along_row = 1.0;
    for (int lag = 1; lag <= static_cast<int>(std::ceil(6.0 * correlation_pixels)); ++lag) {
        const double shared = shared_noise(correlation_pixels, lag);
        along_row += 2.0 * shared * shared;
    }
    return along_row * along_row;
}

double cell_sigma_m(const NoiseCell& cell, double floor_m, double per_square_metre, double angle_factor) {
    const double axial_m = (floor_m + per_square_metre * cell.depth_term) * (1.0 + angle_factor * cell.angle_term);
    return std::max(1e-9, std::sqrt(axial_m * axial_m + cell.other_variance));
}

AxialFigures fit_axial_figures(std::span<const NoiseCell> cells, const SensorNoise& base, const FreeFigures& free) {
    const std::array<bool, 3> is_free{free.floor, free.per_square_metre, free.angle_factor};
    Eigen::Vector3d x(base.sigma_floor_m, base.sigma_per_square_metre, base.angle_factor);
    double least_m = cells.empty() ? 0.0 : cells.front().sigma_m;
    for (const NoiseCell& cell : cells) least_m = std::min(least_m, cell.sigma_m);
    // Away from 0, where the figures have no slope, and within the measured size.
    if (free.floor) x[0] = 0.5 * least_m;
    if (free.per_square_metre && x[1] == 0.0) x[1] = 1e-4;
    x = least_squares(cells, x, is_free);

    const Equations at = equations_at(cells, x, x);
    const int figures = static_cast<int>(std::count(is_free.begin(), is_free.end(), true));
    const int freedom = static_cast<int>(cells.size()) - figures;
    AxialFigures fitted;
    fitted.misfit = freedom > 0 ? std::sqrt(at.chi_square / freedom) : 1.0;
    const Eigen::Vector3d half = 1.96 * std::max(1.0, fitted.misfit) * deviations(at, is_free);
    const std::array<FittedFigure*, 3> figure{&fitted.floor_m, &fitted.per_square_metre, &fitted.angle_factor};
    for (int i = 0; i < 3; ++i) {
        FittedFigure& one = *figure[static_cast<std::size_t>(i)];
        one = {x[i], x[i], x[i], is_free[static_cast<std::size_t>(i)]};
        if (one.fitted) one.low = std::max(0.0, x[i] - half[i]), one.high = x[i] + half[i];
    }
    return fitted;
}

}  // namespace nearpose::simulate
