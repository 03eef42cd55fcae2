#include "core/observation/observation.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "core/base/check.hpp"

namespace nearpose {
namespace {

void check_size(const std::string& what, int width, int height, std::size_t count, const PinholeCamera& camera) {
    const bool consistent = count == static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    if (consistent && width == camera.width && height == camera.height) return;
    throw std::invalid_argument("observation: the " + what + " has " + std::to_string(width) + " x " +
                                std::to_string(height) + " pixels, the camera " + std::to_string(camera.width) + " x " +
                                std::to_string(camera.height));
}

bool in_range(float depth_m, const SensorModel& sensor) {
    const auto least_m = static_cast<float>(sensor.min_range_m), most_m = static_cast<float>(sensor.max_range_m);
    return depth_m >= least_m && depth_m <= most_m;  // false for NaN
}

// The smallest stride, doubled from 1 on, at which the cloud's projection has few holes.
int stride_that_the_cloud_fills(const std::vector<Eigen::Vector3f>& points, const PinholeCamera& camera,
                                double min_filled_share) {
    constexpr int kMaxStride = 32;
    for (int stride = 1; stride < kMaxStride; stride *= 2) {
        const PinholeCamera coarse = camera_of({0, 0, stride, camera.width / stride, camera.height / stride}, camera);
        std::vector<char> filled(static_cast<std::size_t>(coarse.width) * coarse.height, 0);
        for (const Eigen::Vector3f& point : points) {
            const Eigen::Vector2d uv = coarse.project(point.cast<double>());
            if (const int pixel = coarse.pixel_at(uv.x(), uv.y()); pixel >= 0) filled[pixel] = 1;
        }
        int both = 0, one = 0;
        for (std::size_t p = 0; p + 1 < filled.size(); ++p) {
            if (!filled[p]) continue;
            ++one;
            both += filled[p + 1];
        }
        if (one == 0 || both > min_filled_share * one) return stride;
    }
    return kMaxStride;
}

void validate(const ObservationOptions& options) {
    validate(options.sensor);
    check_option("observation.max_points", options.max_points, 1, 1e7);
    validate(options.noise);
    check_option("observation.min_filled_share", options.min_filled_share, 0.0, 1.0);
}

}  // namespace

const PointIndex& Observation::index() const {
    std::call_once(index_->once, [this] { index_->index.emplace(cloud_.points_in_camera); });
    return *index_->index;
}

Observation make_observation(DepthImage depth, const PinholeCamera& camera, const std::optional<Mask>& mask,
                             const ObservationOptions& options) {
    validate(camera);
    validate(options);
    check_size("depth image", depth.width, depth.height, depth.depth_m.size(), camera);
    if (mask) check_size("mask", mask->width, mask->height, mask->value.size(), camera);
    Observation observation;
    observation.camera_ = camera;
    observation.sensor_ = options.sensor;
    observation.segmented_ = mask.has_value();
    observation.image_ = organise(std::move(depth.depth_m), mask, options.sensor);
    observation.candidates_ = find_candidates(observation.image_, camera);
    observation.cloud_ = sample_candidates(observation.image_, camera, observation.candidates_, options.max_points);
    observation.noise_ = {
        measured_noise_factor(observation.image_, camera, observation.candidates_, options.sensor, options.noise),
        measured_shared_noise(observation.image_, camera, options.noise)};
    return observation;
}

Observation make_observation(const std::vector<Eigen::Vector3f>& points_in_camera, const PinholeCamera& camera,
                             const ObservationOptions& options) {
    validate(camera);
    validate(options);
    std::vector<Eigen::Vector3f> points;
    for (const Eigen::Vector3f& point : points_in_camera)
        if (point.allFinite() && in_range(point.z(), options.sensor)) points.push_back(point);

    Observation observation;
    const int stride = stride_that_the_cloud_fills(points, camera, options.min_filled_share);
    observation.camera_ = camera_of({0, 0, stride, camera.width / stride, camera.height / stride}, camera);
    observation.sensor_ = options.sensor;
    observation.segmented_ = true;
    observation.image_ = project_cloud(points, observation.camera_);
    observation.candidates_ = find_candidates(observation.image_, observation.camera_);
    observation.cloud_ =
        sample_candidates(observation.image_, observation.camera_, observation.candidates_, options.max_points);
    return observation;
}

}  // namespace nearpose
