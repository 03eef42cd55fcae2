#include "core/observation/organised_image.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

namespace nearpose {
namespace {

// The loops below run over every pixel of every frame: without branches and over plain arrays the compiler turns them
// into vector instructions.
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

void set_states(const float* depth_m, std::size_t count, PixelState* states) {
    constexpr auto kCandidate = static_cast<std::uint8_t>(PixelState::kCandidate);
    for (std::size_t p = 0; p < count; ++p) states[p] = static_cast<PixelState>(depth_m[p] > 0.0F ? kCandidate : 0);
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

OrganisedImage organise(std::vector<float> depth_m, const std::optional<Mask>& mask, const SensorModel& sensor) {
    OrganisedImage image;
    image.depth_m = std::move(depth_m);
    keep_in_range(image.depth_m.data(), image.depth_m.size(), static_cast<float>(sensor.min_range_m),
                  static_cast<float>(sensor.max_range_m));
    image.states.resize(image.depth_m.size());
    if (mask)
        set_states(image.depth_m.data(), mask->value.data(), image.depth_m.size(), image.states.data());
    else
        set_states(image.depth_m.data(), image.depth_m.size(), image.states.data());
    return image;
}

OrganisedImage project_cloud(const std::vector<Eigen::Vector3f>& points_in_camera, const PinholeCamera& camera) {
    OrganisedImage image;
    const std::size_t pixels = static_cast<std::size_t>(camera.width) * camera.height;
    image.depth_m.assign(pixels, 0.0F);
    image.states.assign(pixels, PixelState::kNoDepth);
    for (const Eigen::Vector3f& point : points_in_camera) {
        const Eigen::Vector2d uv = camera.project(point.cast<double>());
        const int pixel = camera.pixel_at(uv.x(), uv.y());
        if (pixel < 0) continue;
        float& depth = image.depth_m[pixel];
        if (image.states[pixel] == PixelState::kNoDepth || point.z() < depth) depth = point.z();
        image.states[pixel] = PixelState::kCandidate;
    }
    return image;
}

CandidateExtent find_candidates(const OrganisedImage& image, const PinholeCamera& camera) {
    CandidateExtent candidates;
    std::vector<std::uint8_t> columns(static_cast<std::size_t>(camera.width), 0);
    int first_v = camera.height, last_v = 0;
    for (int v = 0; v < camera.height; ++v) {
        const PixelState* row = image.states.data() + static_cast<std::ptrdiff_t>(v) * camera.width;
        const int count = count_candidates(row, camera.width);
        if (count == 0) continue;
        mark_columns(row, columns.size(), columns.data());
        candidates.count += count;
        first_v = std::min(first_v, v);
        last_v = v + 1;
    }
    if (candidates.count == 0) return candidates;
    const auto first = std::find(columns.begin(), columns.end(), 1);
    const auto last = std::find(columns.rbegin(), columns.rend(), 1);
    candidates.box = {static_cast<int>(first - columns.begin()), first_v, static_cast<int>(columns.rend() - last),
                      last_v};
    return candidates;
}

Eigen::Vector3f normal_at(const OrganisedImage& image, const PinholeCamera& camera, int pixel, int reach) {
    const int u = pixel % camera.width, v = pixel / camera.width;
    if (u < reach || v < reach || u + reach >= camera.width || v + reach >= camera.height) return {0, 0, 0};
    const int left = pixel - reach, right = pixel + reach;
    const int above = pixel - reach * camera.width, below = pixel + reach * camera.width;
    const float depth = image.depth_m[pixel];
    constexpr double kSteepest = 4.0;  // depth per width [m / m]; a larger step is an edge, not a slope
    const double max_step_m = kSteepest * reach * depth / camera.fx;
    for (const int neighbour : {left, right, above, below}) {
        if (image.states[neighbour] == PixelState::kNoDepth || std::abs(image.depth_m[neighbour] - depth) > max_step_m)
            return {0, 0, 0};
    }
    const Eigen::Vector3d across = point_at(image, camera, right) - point_at(image, camera, left);
    const Eigen::Vector3d down = point_at(image, camera, below) - point_at(image, camera, above);
    const Eigen::Vector3d towards_camera = down.cross(across);  // x right, y down, z forward: this one points to -z
    const double length = towards_camera.norm();
    if (!(length > 0.0)) return {0, 0, 0};
    return (towards_camera / length).cast<float>();
}

CandidateCloud sample_candidates(const OrganisedImage& image, const PinholeCamera& camera,
                                 const CandidateExtent& candidates, int max_points) {
    CandidateCloud cloud;
    const double every = std::sqrt(static_cast<double>(candidates.count) / max_points);
    const int stride = std::max(1, static_cast<int>(std::ceil(every)));
    for (int v = candidates.box.first_v; v < candidates.box.last_v; v += stride) {
        for (int u = candidates.box.first_u; u < candidates.box.last_u; u += stride) {
            const int pixel = v * camera.width + u;
            if (image.states[pixel] != PixelState::kCandidate) continue;
            cloud.points_in_camera.push_back(point_at(image, camera, pixel).cast<float>());
            cloud.normals_in_camera.push_back(normal_at(image, camera, pixel, std::max(2, stride)));
        }
    }
    if (cloud.points_in_camera.empty()) return cloud;
    double distances_m = 0.0;
    for (const Eigen::Vector3f& point : cloud.points_in_camera) {
        cloud.centroid_in_camera += point.cast<double>();
        distances_m += point.cast<double>().norm();
    }
    const double count = static_cast<double>(cloud.points_in_camera.size());
    cloud.centroid_in_camera /= count;
    cloud.mean_distance_m = distances_m / count;
    return cloud;
}

}  // namespace nearpose
