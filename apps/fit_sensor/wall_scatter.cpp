#include "apps/fit_sensor/wall_scatter.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace nearpose::simulate {
namespace {

constexpr int kDepthBins = 160, kAngleBins = 36;  // of 10 % and of 2.5 degrees

// What a pose's pixels have in common for all its frames.
struct PixelGeometry {
    std::vector<float> expected_m, step_m;
};

struct PixelSums {
    int count = 0;
    double sum = 0.0, squares = 0.0;

    void add(double value) {
        ++count;
        sum += value;
        squares += value * value;
    }
    double mean() const { return count == 0 ? 0.0 : sum / count; }
};

PixelGeometry geometry_of(const Wall& wall, const WallPose& pose, const WallSensor& sensor) {
    const PinholeCamera& camera = wall.camera(pose);
    PixelGeometry geometry;
    for (int pixel = 0; pixel < wall.size(); ++pixel) {
        const Eigen::Vector3d ray = wall.ray(camera, pixel);
        const bool seen = pose.plane.inverse_m.dot(ray) > 1e-3;  // nearer than a kilometre
        geometry.expected_m.push_back(seen ? static_cast<float>(expected_sigma_m(sensor, camera, pose.plane, ray))
                                           : 0.0F);
        geometry.step_m.push_back(seen ? static_cast<float>(depth_step_m(sensor, camera, pose.plane.depth_m(ray)))
                                       : 0.0F);
    }
    return geometry;
}

// Depth less the plane's, by pixel of the region [m]; NaN where there is none or an outlier.
std::vector<double> residuals_of(const Wall& wall, std::size_t frame_index, const PixelGeometry& geometry,
                                 double spread) {
    const WallFrame& frame = wall.frames[frame_index];
    const WallPlane& plane = wall.planes[frame_index];
    std::vector<double> residuals(static_cast<std::size_t>(wall.size()), std::numeric_limits<double>::quiet_NaN());
    for (int pixel = 0; pixel < wall.size(); ++pixel) {
        const auto index = static_cast<std::size_t>(pixel);
        const double depth_m = wall.depth_m(frame, pixel);
        if (!(depth_m > 0.0) || geometry.expected_m[index] == 0.0F) continue;
        const double residual_m = depth_m - plane.depth_m(wall.ray(frame.camera, pixel));
        if (is_outlier(residual_m, geometry.expected_m[index], spread, geometry.step_m[index])) continue;
        residuals[index] = residual_m;
    }
    return residuals;
}

// Products of neighbouring deviations along rows and columns, in expected standard deviations.
void add_autocorrelation(const Wall& wall, const std::vector<double>& deviations, Measured& measured) {
    const int width = wall.width(), height = wall.size() / width;
    for (int v = 0; v < height; ++v) {
        for (int u = 0; u < width; ++u) {
            const auto here = static_cast<std::size_t>(v * width + u);
            if (u + kLags >= width || v + kLags >= height) continue;
            bool all = true;  // the same pixels for every lag
            for (int lag = 0; lag <= kLags; ++lag) {
                all = all && std::isfinite(deviations[here + lag]) && std::isfinite(deviations[here + lag * width]);
            }
            if (!all) continue;
            measured.squares += deviations[here] * deviations[here];
            for (int lag = 1; lag <= kLags; ++lag) {
                const auto index = static_cast<std::size_t>(lag - 1);
                measured.row_products[index] += deviations[here] * deviations[here + lag];
                measured.column_products[index] += deviations[here] * deviations[here + lag * width];
            }
        }
    }
}

// Adds a pixel to the mean of its cell; divided by the cell's freedom at the end.
void add_pixel(NoiseCell& cell, const SensorNoise& noise, double depth_m, double angle_rad, double other_variance,
               double freedom, double square_sum) {
    const double far_m = depth_m - noise.sigma_least_at_m;
    const double ratio = std::min(angle_rad, 1.5) / (M_PI / 2 - std::min(angle_rad, 1.5));
    cell.freedom += freedom;
    cell.depth_m += freedom * depth_m;
    cell.angle_rad += freedom * angle_rad;
    cell.depth_term += freedom * far_m * far_m;
    cell.angle_term += freedom * ratio * ratio;
    cell.other_variance += freedom * other_variance;
    cell.sigma_m += square_sum;
}

void finish_cell(NoiseCell& cell) {
    for (double* sum :
         {&cell.depth_m, &cell.angle_rad, &cell.depth_term, &cell.angle_term, &cell.other_variance, &cell.sigma_m}) {
        *sum /= cell.freedom;
    }
    cell.sigma_m = std::sqrt(cell.sigma_m);
}

// The scatter of each pixel of a pose, put into cells; fixed error beside it.
void add_cells(const Wall& wall, const WallPose& pose, const WallSensor& sensor, const std::vector<PixelSums>& pixels,
               Measured& measured) {
    WallGroup group{.frames = static_cast<int>(pose.frames.size()), .min_depth_m = 1e9, .min_angle_rad = 1e9};
    std::vector<NoiseCell> cells(static_cast<std::size_t>(kDepthBins) * kAngleBins);
    double bias_square_sum = 0.0;
    for (int pixel = 0; pixel < wall.size(); ++pixel) {
        const PixelSums& sums = pixels[static_cast<std::size_t>(pixel)];
        if (sums.count < (wall.separated ? 2 : 1)) continue;
        const PinholeCamera& camera = wall.camera(pose);
        const Eigen::Vector3d ray = wall.ray(camera, pixel);
        const double depth_m = pose.plane.depth_m(ray), angle_rad = pose.plane.angle_rad(ray);
        const double freedom = wall.separated ? sums.count - 1 : sums.count;
        const double about_m = wall.separated ? sums.mean() : 0.0;
        const double square_sum = std::max(0.0, sums.squares - sums.count * about_m * about_m);
        const int depth_bin = std::clamp(static_cast<int>(std::floor(std::log(depth_m) / 0.1)) + 70, 0, kDepthBins - 1);
        const int angle_bin = std::min(static_cast<int>(angle_rad / (M_PI / 72)), kAngleBins - 1);
        add_pixel(cells[static_cast<std::size_t>(depth_bin * kAngleBins + angle_bin)], sensor.noise, depth_m, angle_rad,
                  other_variance(sensor, camera, pose.plane, depth_m), freedom, square_sum);
        // The mean holds a part of the noise, too.
        bias_square_sum += about_m * about_m - square_sum / freedom / sums.count;
        ++group.pixels;
        group.min_depth_m = std::min(group.min_depth_m, depth_m);
        group.max_depth_m = std::max(group.max_depth_m, depth_m);
        group.min_angle_rad = std::min(group.min_angle_rad, angle_rad);
        group.max_angle_rad = std::max(group.max_angle_rad, angle_rad);
    }
    for (NoiseCell& cell : cells) {
        if (cell.freedom == 0.0) continue;
        finish_cell(cell);
        cell.group = static_cast<int>(measured.groups.size());
        measured.cells.push_back(cell);
    }
    if (wall.separated && group.pixels > 0) {
        group.bias_m = std::sqrt(std::max(0.0, bias_square_sum / group.pixels));
        measured.bias_square_sum += bias_square_sum;
        measured.bias_pixels += group.pixels;
    }
    measured.groups.push_back(group);
}

}  // namespace

Measured measure(const Wall& wall, const WallSensor& sensor) {
    Measured measured;
    for (const WallPose& pose : wall.poses) {
        const PixelGeometry geometry = geometry_of(wall, pose, sensor);
        std::vector<PixelSums> pixels(static_cast<std::size_t>(wall.size()));
        std::vector<double> spreads;
        for (const std::size_t frame : pose.frames) {
            spreads.push_back(robust_spread(wall.frames[frame], wall.region, wall.planes[frame], sensor));
            const std::vector<double> residuals = residuals_of(wall, frame, geometry, spreads.back());
            for (std::size_t i = 0; i < residuals.size(); ++i) {
                if (std::isfinite(residuals[i])) pixels[i].add(residuals[i]);
            }
        }
        // Again instead of kept: recordings are long.
        for (std::size_t k = 0; k < pose.frames.size(); ++k) {
            std::vector<double> deviations = residuals_of(wall, pose.frames[k], geometry, spreads[k]);
            for (std::size_t i = 0; i < deviations.size(); ++i) {
                if (wall.separated) deviations[i] -= pixels[i].count < 2 ? NAN : pixels[i].mean();
                deviations[i] /= geometry.expected_m[i];
            }
            add_autocorrelation(wall, deviations, measured);
        }
        add_cells(wall, pose, sensor, pixels, measured);
    }
    return measured;
}

}  // namespace nearpose::simulate
