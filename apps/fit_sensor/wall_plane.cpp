#include "apps/fit_sensor/wall_plane.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

namespace nearpose::simulate {
namespace {

constexpr double kLeastSigma_m = 1e-4;  // for sensors that claim less
constexpr int kMaxSamples = 6000;       // a plane of so many pixels lies within 3 % of the noise
constexpr int kBlock = 8;               // [pixels]

struct Sample {
    Eigen::Vector3d ray;
    double depth_m = 0.0;
    double sigma_m = 0.0;
};

double median(std::vector<double> values) {
    if (values.empty()) return 0.0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

float depth_at(const WallFrame& frame, int u, int v) {
    return frame.depth.depth_m[static_cast<std::size_t>(v) * frame.camera.width + u];
}

std::vector<Sample> samples_of(const WallFrame& frame, const PixelBox& region, const WallSensor& sensor) {
    const double area = static_cast<double>(region.last_u - region.first_u) * (region.last_v - region.first_v);
    const int stride = std::max(1, static_cast<int>(std::ceil(std::sqrt(area / kMaxSamples))));
    std::vector<Sample> samples;
    for (int v = region.first_v; v < region.last_v; v += stride) {
        for (int u = region.first_u; u < region.last_u; u += stride) {
            const double depth_m = depth_at(frame, u, v);
            if (!(depth_m > 0.0)) continue;
            samples.push_back(
                {frame.camera.ray(u, v), depth_m, std::max(kLeastSigma_m, sensor.noise.sigma_m(depth_m))});
        }
    }
    return samples;
}

// Residual of inverse depth as a residual of depth in standard deviations: d(1/z) = dz / z^2.
double residual_in_sigmas(const Sample& sample, const WallPlane& plane) {
    const double inverse_residual = 1.0 / sample.depth_m - plane.inverse_m.dot(sample.ray);
    return inverse_residual * sample.depth_m * sample.depth_m / sample.sigma_m;
}

double huber_weight(double residual, double spread) {
    return 1.0 / std::max(1.0, std::abs(residual) / (0.5 * spread));
}

double tukey_weight(double residual, double spread) {
    const double ratio = residual / (4.685 * spread);
    const double rest = std::max(0.0, 1.0 - ratio * ratio);
    return rest * rest;
}

template <typename Weight>
WallPlane reweighted(const std::vector<Sample>& samples, const WallPlane& before, const Weight& weight) {
    std::vector<double> residuals, sizes;
    for (const Sample& sample : samples) {
        residuals.push_back(residual_in_sigmas(sample, before));
        sizes.push_back(std::abs(residuals.back()));
    }
    const double spread = std::max(1e-6, 1.4826 * median(std::move(sizes)));
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const Sample& sample = samples[i];
        const double per_sigma = sample.depth_m * sample.depth_m / sample.sigma_m;
        const double w = weight(residuals[i], spread) * per_sigma * per_sigma;
        normal += w * sample.ray * sample.ray.transpose();
        right += w / sample.depth_m * sample.ray;
    }
    return {normal.ldlt().solve(right)};
}

// Until the plane moves by less than that part of its distance.
template <typename Weight>
WallPlane settled(const std::vector<Sample>& samples, WallPlane plane, const Weight& weight, double part, int rounds) {
    for (int i = 0; i < rounds; ++i) {
        const WallPlane before = plane;
        plane = reweighted(samples, before, weight);
        if ((plane.inverse_m - before.inverse_m).norm() < part * plane.inverse_m.norm()) break;
    }
    return plane;
}

WallPlane robust_plane(const std::vector<Sample>& samples) {
    std::vector<double> depths;
    for (const Sample& sample : samples) depths.push_back(sample.depth_m);
    WallPlane plane{Eigen::Vector3d(0.0, 0.0, 1.0 / median(std::move(depths)))};
    plane = reweighted(samples, plane, [](double, double) { return 1.0; });
    plane = settled(samples, plane, huber_weight, 1e-5, 15);
    plane = settled(samples, plane, tukey_weight, 1e-7, 10);
    return plane;
}

// Counts of outliers, and how much of the variance is shared by blocks of pixels.
void judge(const WallFrame& frame, const PixelBox& region, const WallSensor& sensor, WallFit& fit) {
    const double spread = robust_spread(frame, region, fit.plane, sensor);
    double total = 0.0, shared = 0.0;
    int inliers = 0, in_blocks = 0;
    for (int v0 = region.first_v; v0 < region.last_v; v0 += kBlock) {
        for (int u0 = region.first_u; u0 < region.last_u; u0 += kBlock) {
            double sum = 0.0;
            int count = 0;
            for (int v = v0; v < std::min(v0 + kBlock, region.last_v); ++v) {
                for (int u = u0; u < std::min(u0 + kBlock, region.last_u); ++u) {
                    const double depth_m = depth_at(frame, u, v);
                    if (!(depth_m > 0.0)) continue;
                    ++fit.pixels;
                    const Eigen::Vector3d ray = frame.camera.ray(u, v);
                    const double on_plane_m = fit.plane.depth_m(ray);
                    if (!(on_plane_m > 0.0)) continue;
                    const double expected_m = expected_sigma_m(sensor, frame.camera, fit.plane, ray);
                    const double residual_m = depth_m - on_plane_m;
                    const double step_m = depth_step_m(sensor, frame.camera, on_plane_m);
                    if (is_outlier(residual_m, expected_m, spread, step_m)) continue;
                    total += residual_m * residual_m / (expected_m * expected_m);
                    sum += residual_m / expected_m;
                    ++count;
                }
            }
            inliers += count;
            if (count < kBlock * kBlock / 2) continue;
            shared += sum * sum / count;  // count times the square of the mean
            in_blocks += count;
        }
    }
    fit.outlier_share = fit.pixels == 0 ? 1.0 : 1.0 - static_cast<double>(inliers) / fit.pixels;
    if (in_blocks > 0 && total > 0.0) fit.structured_share = shared / in_blocks / (total / inliers);
}

}  // namespace

double WallPlane::angle_rad(const Eigen::Vector3d& ray) const {
    return std::acos(std::min(1.0, std::abs(inverse_m.dot(ray)) / (inverse_m.norm() * ray.norm())));
}

double depth_step_m(const WallSensor& sensor, const PinholeCamera& camera, double depth_m) {
    const double per_pixel = camera.fx * sensor.noise.baseline_m;  // [pixel m]
    if (per_pixel == 0.0) return sensor.count_m;
    return std::max(sensor.count_m, depth_m * depth_m * sensor.noise.disparity_step_pixels / per_pixel);
}

double other_variance(const WallSensor& sensor, const PinholeCamera& camera, const WallPlane& plane, double depth_m) {
    const SensorNoise& noise = sensor.noise;
    const double square = depth_m * depth_m;
    // Change of depth from pixel to pixel.
    const Eigen::Vector2d slope_m(square * plane.inverse_m.x() / camera.fx, square * plane.inverse_m.y() / camera.fy);
    const double per_pixel = camera.fx * noise.baseline_m;
    const double disparity_m = per_pixel == 0.0 ? 0.0 : square * noise.disparity_step_pixels / per_pixel;
    return slope_m.squaredNorm() * noise.jitter_pixels * noise.jitter_pixels +
           noise.frame_bias_sigma_m * noise.frame_bias_sigma_m +
           (disparity_m * disparity_m + sensor.count_m * sensor.count_m) / 12.0;
}

double expected_sigma_m(const WallSensor& sensor, const PinholeCamera& camera, const WallPlane& plane,
                        const Eigen::Vector3d& ray) {
    const double depth_m = plane.depth_m(ray);
    const double axial_m = sensor.noise.sigma_m(depth_m, plane.angle_rad(ray));
    const double variance = axial_m * axial_m + other_variance(sensor, camera, plane, depth_m) +
                            sensor.noise.bias_sigma_m * sensor.noise.bias_sigma_m;
    return std::max(kLeastSigma_m, std::sqrt(variance));
}

bool is_outlier(double residual_m, double expected_m, double spread, double step_m) {
    // One step beside the right one is no outlier, however still the sensor is.
    return std::abs(residual_m) > std::max(6.0 * spread * expected_m, 1.5 * step_m);
}

PixelBox region_of(const PinholeCamera& camera, const std::optional<PixelBox>& region) {
    const PixelBox whole{0, 0, camera.width, camera.height};
    if (!region) return whole;
    if (region->first_u < 0 || region->first_v < 0 || region->last_u > camera.width || region->last_v > camera.height ||
        region->empty()) {
        throw std::invalid_argument("region: must lie in the image of " + std::to_string(camera.width) + " x " +
                                    std::to_string(camera.height) + " pixels");
    }
    return *region;
}

double robust_spread(const WallFrame& frame, const PixelBox& region, const WallPlane& plane, const WallSensor& sensor) {
    std::vector<double> sizes;
    for (const Sample& sample : samples_of(frame, region, sensor)) {
        const double on_plane_m = plane.depth_m(sample.ray);
        if (!(on_plane_m > 0.0)) continue;
        sizes.push_back(std::abs(sample.depth_m - on_plane_m) /
                        expected_sigma_m(sensor, frame.camera, plane, sample.ray));
    }
    return 1.4826 * median(std::move(sizes));
}

std::optional<WallFit> fit_wall_plane(const WallFrame& frame, const PixelBox& region, const WallSensor& sensor,
                                      int min_pixels) {
    int pixels = 0;
    for (int v = region.first_v; v < region.last_v; ++v) {
        for (int u = region.first_u; u < region.last_u; ++u) pixels += depth_at(frame, u, v) > 0.0F;
    }
    if (pixels < min_pixels) return std::nullopt;
    const std::vector<Sample> samples = samples_of(frame, region, sensor);
    WallFit fit;
    fit.plane = robust_plane(samples);
    std::vector<double> sizes, expected;
    for (const Sample& sample : samples) {
        const double on_plane_m = fit.plane.depth_m(sample.ray);
        if (!(on_plane_m > 0.0)) continue;
        sizes.push_back(std::abs(sample.depth_m - on_plane_m));
        expected.push_back(expected_sigma_m(sensor, frame.camera, fit.plane, sample.ray));
    }
    fit.rms_m = 1.4826 * median(std::move(sizes));
    fit.expected_m = median(std::move(expected));
    judge(frame, region, sensor, fit);
    return fit;
}

}  // namespace nearpose::simulate
