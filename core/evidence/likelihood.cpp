#include "core/evidence/likelihood.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace nearpose {

double overlap_scaled_mse(const Correspondences& pairs, const Pose& camera_from_object, std::size_t num_view_points,
                          double max_distance_m) {
    const double m = static_cast<double>(num_view_points);
    const double n = static_cast<double>(pairs.size());
    if (pairs.size() == 0) return (m + 1.0) * max_distance_m * max_distance_m;
    double sum_m2 = 0.0;
    for (std::size_t k = 0; k < pairs.size(); ++k) {
        const Eigen::Vector3d model = camera_from_object * pairs.points_in_object[k].cast<double>();
        sum_m2 += (model - pairs.points_in_camera[k].cast<double>()).squaredNorm();
    }
    return m / n * (sum_m2 / n);
}

double negative_log_likelihood(double overlap_scaled_mse_m2, double sensor_sigma_m, double max_distance_m) {
    const double variance_m2 = sensor_sigma_m * sensor_sigma_m + 0.6 * max_distance_m * max_distance_m;
    return overlap_scaled_mse_m2 / (2.0 * variance_m2);
}

namespace {

// Of model before the measured surface, where nothing is segmented.
double cost_in_front(double depth_m, const PixelCostOptions& options) {
    if (!(options.free_space_depth_m > 0.0)) return 1.0;
    return 1.0 + (options.free_space_cost - 1.0) * std::clamp(depth_m / options.free_space_depth_m - 1.0, 0.0, 1.0);
}

// The cost of one ray that meets the model, and its count.
double cost_of_hit(double in_front_m, double residual_m, double sigma_m, PixelState state, bool segmented,
                   double weight, const PixelCostOptions& options, PixelCost& counts) {
    const double r = residual_m / (options.truncation_sigmas * sigma_m);  // positive: the model is in front
    if (r > 1.0) {
        ++counts.free_space_violations;
        ++counts.contradicted;
        return segmented ? 1.0 : cost_in_front(in_front_m, options);
    }
    if (r < -1.0) {
        ++counts.occluded;
        if (segmented && state == PixelState::kCandidate) {
            ++counts.contradicted;
            return 1.0;
        }
        return segmented ? options.occluded_cost : weight * options.unexplained_cost;
    }
    if (state == PixelState::kBackground) {
        ++counts.off_mask;
        return options.occluded_cost;
    }
    ++counts.agreeing;
    return weight * r * r;
}

// One hit in camera coordinates.
struct Hit {
    Eigen::Vector3f point;
    Eigen::Vector3f normal;
    int index = 0;  // of the grid
};

enum class Outline { kInside, kEnds, kGoesOn };

// Whether the model ends at this ray, and if so, whether the measured surface goes on in the model's tangent plane.
Outline outline_at(const Hit& hit, const ObservedGrid& observed, const std::vector<char>& covered, double sigma_m) {
    constexpr int kBeyond = 2;  // grid steps: the one beside the outline may be a mixed pixel
    const int width = observed.grid.width, height = observed.grid.height;
    const int u = hit.index % width, v = hit.index / width;
    const float distance_m = hit.normal.dot(hit.point);
    Outline outline = Outline::kInside;
    for (const auto& [du, dv] : {std::pair{1, 0}, std::pair{-1, 0}, std::pair{0, 1}, std::pair{0, -1}}) {
        const int far_u = u + kBeyond * du, far_v = v + kBeyond * dv;
        if (far_u < 0 || far_v < 0 || far_u >= width || far_v >= height) continue;
        const int beside = (v + dv) * width + u + du, beyond = far_v * width + far_u;
        if (covered[beside] || covered[beyond] || observed.states[beyond] == PixelState::kNoDepth) continue;
        const Eigen::Vector3f ray = observed.camera.ray(far_u, far_v).cast<float>();
        const float off_m = hit.normal.dot(ray) * observed.depth_m[beyond] - distance_m;  // along the normal
        if (std::abs(off_m) < 3.0 * std::hypot(sigma_m, observed.sigma_m[beyond])) return Outline::kGoesOn;
        outline = Outline::kEnds;
    }
    return outline;
}

double total_weight(const ObservedGrid& observed) {
    double sum = 0.0;
    for (int index = 0; index < observed.grid.size(); ++index)
        if (observed.states[index] == PixelState::kCandidate) sum += observed.weight(index);
    return sum;
}

// Covers what lies between the first and the last covered pixel of a line of `count` pixels.
void cover_between(const std::vector<char>& covered, int first, int step, int count, std::vector<char>& filled) {
    int from = 0, to = count - 1;
    while (from < count && !covered[first + from * step]) ++from;
    while (to > from && !covered[first + to * step]) --to;
    for (int i = from; i <= to; ++i) filled[first + i * step] = 1;
}

// Which of the grid's pixels show the model. Gaps between samples are filled along rows and columns: they are no
// outline.
std::vector<char> covered_by(const View& view, const PixelGrid& grid) {
    std::vector<char> covered(static_cast<std::size_t>(grid.size()), 0);
    for (const int pixel : view.pixels) covered[pixel] = 1;
    if (!view.of_samples) return covered;
    std::vector<char> filled = covered;
    for (int v = 0; v < grid.height; ++v) cover_between(covered, v * grid.width, 1, grid.width, filled);
    for (int u = 0; u < grid.width; ++u) cover_between(covered, u, grid.width, grid.height, filled);
    return filled;
}

// Where the pixel's ray meets the tangent plane of a sample within the pixel; the sample where they hardly meet.
Eigen::Vector3f on_ray(const Hit& sample, const ObservedGrid& observed) {
    constexpr float kLeastCosine = 0.1F;
    const int width = observed.grid.width;
    const Eigen::Vector3f ray = observed.camera.ray(sample.index % width, sample.index / width).cast<float>();
    const float slope = sample.normal.dot(ray);
    return std::abs(slope) < kLeastCosine * ray.norm() ? sample.point
                                                       : Eigen::Vector3f(sample.normal.dot(sample.point) / slope * ray);
}

}  // namespace

PixelCost pixel_cost(const View& view, const Pose& camera_from_object, const ObservedGrid& observed,
                     const PixelCostOptions& options) {
    const Eigen::Matrix3f rotation = camera_from_object.rotation_matrix().cast<float>();
    const Eigen::Vector3f translation = camera_from_object.translation.cast<float>();
    const double extra_variance_m2 = options.extra_sigma_m * options.extra_sigma_m;
    const std::vector<char> covered = options.with_outline ? covered_by(view, observed.grid) : std::vector<char>{};
    PixelCost result;
    result.segmented = observed.segmented;
    double sum = 0.0, covered_weight = 0.0, explained = 0.0;
    int candidates_covered = 0;
    for (std::size_t k = 0; k < view.size(); ++k) {
        const int index = view.pixels[k];
        const PixelState state = observed.states[index];
        if (state == PixelState::kNoDepth) continue;
        Hit hit{rotation * view.points_in_object[k] + translation, rotation * view.normals_in_object[k], index};
        if (view.of_samples) hit.point = on_ray(hit, observed);
        const double cosine = std::abs(hit.normal.dot(hit.point)) / hit.point.norm();
        const double sensor_m = observed.sigma_m[index];
        const double sigma_m = std::sqrt(sensor_m * sensor_m + extra_variance_m2);
        const double in_front_m = observed.depth_m[index] - hit.point.z();
        candidates_covered += state == PixelState::kCandidate;
        ++result.model_rays;
        const int agreeing_before = result.agreeing;
        const double weight = observed.weight(index);
        covered_weight += weight;
        const double cost =
            cost_of_hit(in_front_m, in_front_m * cosine, sigma_m, state, observed.segmented, weight, options, result);
        sum += cost;
        if (!options.with_outline || result.agreeing == agreeing_before) continue;
        const Outline outline = outline_at(hit, observed, covered, options.outline_sigma_m);
        result.outline += outline != Outline::kInside;
        if (outline != Outline::kGoesOn) {
            explained += weight * options.unexplained_cost - cost;
            continue;
        }
        ++result.coplanar;
        if (observed.segmented) continue;
        --result.agreeing;
        sum += options.outline_cost - cost;
    }
    // The more of its outline the surface goes on beyond, the less what lies within is the object.
    if (!observed.segmented) sum += result.coplanar_share() * result.coplanar_share() * std::max(0.0, explained);
    result.missing_model = observed.num_candidates - candidates_covered;
    result.gain = options.unexplained_cost * covered_weight - sum;
    double missing = result.missing_model;
    if (!observed.weights.empty()) missing = total_weight(observed) - covered_weight;
    sum += missing * (observed.segmented ? 1.0 : options.unexplained_cost);
    result.judged = result.model_rays + result.missing_model;
    result.cost = result.judged > 0 ? sum / result.judged : 1.0;
    return result;
}

double log_evidence(const PixelCost& cost, const PixelCostOptions& options, double rays_per_evidence) {
    return -0.5 * options.truncation_sigmas * options.truncation_sigmas * cost.cost * cost.judged / rays_per_evidence;
}

double log_evidence_over_nothing(const PixelCost& cost, const PixelCostOptions& options, double rays_per_evidence) {
    PixelCost nothing = cost;
    nothing.cost = 1.0;
    return log_evidence(cost, options, rays_per_evidence) - log_evidence(nothing, options, rays_per_evidence);
}

double negative_log_likelihood(const PixelCost& cost, const PixelCostOptions& options) {
    return 0.5 * options.independent_rays * options.truncation_sigmas * options.truncation_sigmas * cost.cost;
}

}  // namespace nearpose
