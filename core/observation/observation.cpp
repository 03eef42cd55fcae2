#include "core/observation/observation.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "core/base/check.hpp"
#include "core/base/statistics.hpp"

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

// Of the cloud's own sampling: the coarsest stride at which neighbouring pixels of its projection are all but filled.
int stride_that_the_cloud_fills(const std::vector<Eigen::Vector3f>& points, const PinholeCamera& camera) {
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
        if (one == 0 || both > 0.8 * one) return stride;
    }
    return kMaxStride;
}

}  // namespace

Eigen::Vector3f Observation::normal_at(int pixel, int reach) const {
    const int u = pixel % camera_.width, v = pixel / camera_.width;
    if (u < reach || v < reach || u + reach >= camera_.width || v + reach >= camera_.height) return {0, 0, 0};
    const int left = pixel - reach, right = pixel + reach;
    const int above = pixel - reach * camera_.width, below = pixel + reach * camera_.width;
    const float depth = depth_m_[pixel];
    // A step of more than the surface's reach in depth per pixel of width is an edge, not a slope.
    const double max_step_m = 4.0 * reach * depth / camera_.fx;
    for (const int neighbour : {left, right, above, below}) {
        if (states_[neighbour] == PixelState::kNoDepth || std::abs(depth_m_[neighbour] - depth) > max_step_m)
            return {0, 0, 0};
    }
    const Eigen::Vector3d across = point_at(right) - point_at(left);
    const Eigen::Vector3d down = point_at(below) - point_at(above);
    const Eigen::Vector3d towards_camera = down.cross(across);  // x right, y down, z forward: this one points to -z
    const double length = towards_camera.norm();
    if (!(length > 0.0)) return {0, 0, 0};
    return (towards_camera / length).cast<float>();
}

namespace {

// Loops without branches over plain arrays, which the compiler turns into vector instructions: they run over every
// pixel of every frame.
void keep_in_range(float* depth_m, std::size_t count, float least_m, float most_m) {
    for (std::size_t p = 0; p < count; ++p)
        depth_m[p] = (depth_m[p] >= least_m) & (depth_m[p] <= most_m) ? depth_m[p] : 0.0F;  // 0 for NaN
}

void set_states(const float* depth_m, const std::uint8_t* mask, std::size_t count, PixelState* states) {
    constexpr auto kCandidate = static_cast<std::uint8_t>(PixelState::kCandidate);
    constexpr auto kBackground = static_cast<std::uint8_t>(PixelState::kBackground);
    static_assert(static_cast<int>(PixelState::kNoDepth) == 0);
    for (std::size_t p = 0; p < count; ++p) {
        const std::uint8_t measured = mask[p] != 0 ? kCandidate : kBackground;
        states[p] = static_cast<PixelState>(depth_m[p] > 0.0F ? measured : 0);
    }
}

int count_candidates(const PixelState* states, int count) {
    constexpr int kBlock = 128;  // a byte holds its count
    int sum = 0;
    for (int begin = 0; begin < count; begin += kBlock) {
        std::uint8_t of_block = 0;
        for (int p = begin; p < std::min(count, begin + kBlock); ++p)
            of_block = static_cast<std::uint8_t>(of_block + (states[p] == PixelState::kCandidate));
        sum += of_block;
    }
    return sum;
}

void mark_columns(const PixelState* states, std::size_t count, std::uint8_t* columns) {
    for (std::size_t u = 0; u < count; ++u)
        columns[u] |= static_cast<std::uint8_t>(states[u] == PixelState::kCandidate);
}

}  // namespace

void Observation::take_pixels(std::vector<float> depth_m, const std::optional<Mask>& mask) {
    depth_m_ = std::move(depth_m);
    keep_in_range(depth_m_.data(), depth_m_.size(), static_cast<float>(sensor_.min_range_m),
                  static_cast<float>(sensor_.max_range_m));
    states_.resize(depth_m_.size());
    const std::vector<std::uint8_t> everything(mask ? 0 : depth_m_.size(), 1);
    set_states(depth_m_.data(), mask ? mask->value.data() : everything.data(), depth_m_.size(), states_.data());
}

void Observation::find_candidates() {
    std::vector<std::uint8_t> columns(static_cast<std::size_t>(camera_.width), 0);
    int first_v = camera_.height, last_v = 0;
    for (int v = 0; v < camera_.height; ++v) {
        const PixelState* row = states_.data() + static_cast<std::ptrdiff_t>(v) * camera_.width;
        const int count = count_candidates(row, camera_.width);
        if (count == 0) continue;
        mark_columns(row, columns.size(), columns.data());
        num_candidates_ += count;
        first_v = std::min(first_v, v);
        last_v = v + 1;
    }
    if (num_candidates_ == 0) return;
    const auto first = std::find(columns.begin(), columns.end(), 1);
    const auto last = std::find(columns.rbegin(), columns.rend(), 1);
    candidate_box_ = {static_cast<int>(first - columns.begin()), first_v, static_cast<int>(columns.rend() - last),
                      last_v};
}

void Observation::sample_cloud(int max_points) {
    const double every = std::sqrt(static_cast<double>(num_candidates_) / max_points);
    const int stride = std::max(1, static_cast<int>(std::ceil(every)));
    for (int v = candidate_box_.first_v; v < candidate_box_.last_v; v += stride) {
        for (int u = candidate_box_.first_u; u < candidate_box_.last_u; u += stride) {
            const int pixel = v * camera_.width + u;
            if (states_[pixel] != PixelState::kCandidate) continue;
            points_in_camera_.push_back(point_at(pixel).cast<float>());
            normals_in_camera_.push_back(normal_at(pixel, std::max(2, stride)));
        }
    }
}

void Observation::measure_cloud() {
    if (points_in_camera_.empty()) return;
    double distances_m = 0.0;
    for (const Eigen::Vector3f& point : points_in_camera_) {
        centroid_in_camera_ += point.cast<double>();
        distances_m += point.cast<double>().norm();
    }
    const double count = static_cast<double>(points_in_camera_.size());
    centroid_in_camera_ /= count;
    mean_distance_m_ = distances_m / count;
}

const PointIndex& Observation::index() const {
    std::call_once(index_->once, [this] { index_->index.emplace(points_in_camera_); });
    return *index_->index;
}

// A plane's inverse depth is linear over the image, so that its second difference is noise alone: of variance 6 / z^4
// sigma^2. The median over the image is not moved by edges and curved places.
void Observation::measure_noise() {
    constexpr int kReach = 3;  // pixels: neighbours share noise
    constexpr std::size_t kMinSamples = 100;
    constexpr double kLeast = 0.5, kMost = 10.0;
    std::vector<double> ratios;
    const int stride = std::max(1, static_cast<int>(std::sqrt(num_candidates_ / 3000.0)));
    for (int v = candidate_box_.first_v; v < candidate_box_.last_v; v += stride) {
        for (int u = candidate_box_.first_u + kReach; u < candidate_box_.last_u - kReach; u += stride) {
            const int pixel = v * camera_.width + u;
            bool usable = true;
            for (const int other : {pixel - kReach, pixel, pixel + kReach})
                usable = usable && states_[other] == PixelState::kCandidate;
            if (!usable) continue;
            const double z_m = depth_m_[pixel];
            const double second = 1.0 / depth_m_[pixel - kReach] - 2.0 / z_m + 1.0 / depth_m_[pixel + kReach];
            ratios.push_back(std::abs(second) * z_m * z_m / (std::sqrt(6.0) * sensor_.sigma_m(z_m)));
        }
    }
    if (ratios.size() < kMinSamples) return;
    noise_factor_ = std::clamp(median(std::move(ratios)) / kMedianOfAbsoluteNormal, kLeast, kMost);
}

ObservedGrid observe(const Observation& observation, const PixelGrid& grid) {
    ObservedGrid observed;
    observed.grid = grid;
    observed.camera = camera_of(grid, observation.camera());
    observed.segmented = observation.segmented();
    observed.states.reserve(grid.size());
    observed.depth_m.reserve(grid.size());
    observed.sigma_m.reserve(grid.size());
    for (int index = 0; index < grid.size(); ++index) {
        const int pixel = grid.image_v(index) * observation.camera().width + grid.image_u(index);
        const float depth_m = observation.depth_m()[pixel];
        observed.states.push_back(observation.states()[pixel]);
        observed.depth_m.push_back(depth_m);
        observed.sigma_m.push_back(static_cast<float>(observation.sigma_m(depth_m)));
        observed.num_candidates += observation.states()[pixel] == PixelState::kCandidate;
    }
    return observed;
}

Observation make_observation(DepthImage depth, const PinholeCamera& camera, const std::optional<Mask>& mask,
                             const ObservationOptions& options) {
    validate(camera);
    validate(options.sensor);
    check_option("observation.max_points", options.max_points, 1, 1e7);
    check_size("depth image", depth.width, depth.height, depth.depth_m.size(), camera);
    if (mask) check_size("mask", mask->width, mask->height, mask->value.size(), camera);
    Observation observation;
    observation.camera_ = camera;
    observation.sensor_ = options.sensor;
    observation.segmented_ = mask.has_value();
    observation.take_pixels(std::move(depth.depth_m), mask);
    observation.find_candidates();
    observation.sample_cloud(options.max_points);
    observation.measure_cloud();
    observation.measure_noise();
    return observation;
}

Observation make_observation(const std::vector<Eigen::Vector3f>& points_in_camera, const PinholeCamera& camera,
                             const ObservationOptions& options) {
    validate(camera);
    validate(options.sensor);
    check_option("observation.max_points", options.max_points, 1, 1e7);
    std::vector<Eigen::Vector3f> points;
    for (const Eigen::Vector3f& point : points_in_camera)
        if (point.allFinite() && in_range(point.z(), options.sensor)) points.push_back(point);

    Observation observation;
    const int stride = stride_that_the_cloud_fills(points, camera);
    observation.camera_ = camera_of({0, 0, stride, camera.width / stride, camera.height / stride}, camera);
    observation.sensor_ = options.sensor;
    observation.segmented_ = true;
    const std::size_t pixels = static_cast<std::size_t>(observation.camera_.width) * observation.camera_.height;
    observation.depth_m_.assign(pixels, 0.0F);
    observation.states_.assign(pixels, PixelState::kNoDepth);
    for (const Eigen::Vector3f& point : points) {
        const Eigen::Vector2d uv = observation.camera_.project(point.cast<double>());
        const int pixel = observation.camera_.pixel_at(uv.x(), uv.y());
        if (pixel < 0) continue;
        float& depth = observation.depth_m_[pixel];
        if (observation.states_[pixel] == PixelState::kNoDepth || point.z() < depth) depth = point.z();
        observation.states_[pixel] = PixelState::kCandidate;
    }
    observation.find_candidates();
    observation.sample_cloud(options.max_points);
    observation.measure_cloud();
    return observation;
}

}  // namespace nearpose
