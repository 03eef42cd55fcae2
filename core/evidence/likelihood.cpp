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
    // 3/5 R^2 is the mean squared distance from the centre of points spread evenly over a ball of radius R.
    const double variance_m2 = sensor_sigma_m * sensor_sigma_m + 0.6 * max_distance_m * max_distance_m;
    return overlap_scaled_mse_m2 / (2.0 * variance_m2);
}

namespace {

// How deep in free space: 0 up to `deep_m` before the measured surface, 1 from twice that on. 0 where nothing is deep.
double deep_share(double depth_m, double deep_m) {
    return deep_m > 0.0 ? std::clamp(depth_m / deep_m - 1.0, 0.0, 1.0) : 0.0;
}

// The cost of model before the measured surface by `depth_m`, where nothing is segmented.
double free_space_cost(double depth_m, const PixelCostOptions& options) {
    return 1.0 + (options.free_space_cost - 1.0) * deep_share(depth_m, options.free_space_depth_m);
}

// A sample of the view in camera coordinates [m].
struct Hit {
    Eigen::Vector3f point;
    Eigen::Vector3f normal;
    int index = 0;  // of the grid
};

// What the model's end looks like at a ray.
enum class Edge {
    kInterior,    // the model goes on in all directions that are measured
    kSilhouette,  // the model ends, and so does the measured surface
    kCoplanar,    // the model ends, but the measured surface goes on in its tangent plane
};

Edge edge_at(const Hit& hit, const ObservedGrid& observed, const std::vector<char>& covered,
             const PixelCostOptions& options) {
    const int width = observed.grid.width, height = observed.grid.height;
    const int u = hit.index % width, v = hit.index / width;
    const float distance_m = hit.normal.dot(hit.point);
    Edge edge = Edge::kInterior;
    for (const auto& [du, dv] : {std::pair{1, 0}, std::pair{-1, 0}, std::pair{0, 1}, std::pair{0, -1}}) {
        const int far_u = u + options.outline_steps * du, far_v = v + options.outline_steps * dv;
        if (far_u < 0 || far_v < 0 || far_u >= width || far_v >= height) continue;
        const int beside = (v + dv) * width + u + du, beyond = far_v * width + far_u;
        if (covered[beside] || covered[beyond] || observed.states[beyond] == PixelState::kNoDepth) continue;
        const Eigen::Vector3f ray = observed.camera.ray(far_u, far_v).cast<float>();
        const float off_m = hit.normal.dot(ray) * observed.depth_m[beyond] - distance_m;  // along the normal
        const double sigma_m = std::hypot(options.outline_sigma_m, observed.sigma_m[beyond]);
        if (std::abs(off_m) < options.outline_gate_sigmas * sigma_m) return Edge::kCoplanar;
        edge = Edge::kSilhouette;
    }
    return edge;
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

// Where the pixel's ray meets the tangent plane of a sample. Where ray and plane are nearly parallel, the sample
// itself.
Eigen::Vector3f on_ray(const Hit& sample, const ObservedGrid& observed) {
    constexpr float kLeastCosine = 0.1F;
    const int width = observed.grid.width;
    const Eigen::Vector3f ray = observed.camera.ray(sample.index % width, sample.index / width).cast<float>();
    const float slope = sample.normal.dot(ray);
    return std::abs(slope) < kLeastCosine * ray.norm() ? sample.point
                                                       : Eigen::Vector3f(sample.normal.dot(sample.point) / slope * ray);
}

// Sums the costs of one view's rays, in their order.
class PixelCostSum {
  public:
    PixelCostSum(const ObservedGrid& observed, const PixelCostOptions& options, std::vector<char> covered)
        : observed_(observed),
          options_(options),
          covered_(std::move(covered)),
          extra_variance_m2_(options.extra_sigma_m * options.extra_sigma_m) {
        counts_.segmented = observed.segmented;
    }

    void add(const Hit& hit);
    // With the candidate pixels that no ray covers.
    PixelCost total() const;

  private:
    // From which depth on a contradiction is deep.
    double deep_m(double sigma_m) const {
        return std::max(options_.free_space_depth_m, options_.deep_sigmas * sigma_m);
    }
    double cost_of(double in_front_m, double residual_m, double sigma_m, PixelState state, double weight);
    void judge_edge(const Hit& hit, double weight, double cost);

    const ObservedGrid& observed_;
    const PixelCostOptions& options_;
    const std::vector<char> covered_;
    const double extra_variance_m2_;
    PixelCost counts_;
    double sum_ = 0.0;
    double covered_weight_ = 0.0;
    double explained_ = 0.0;  // by agreeing rays that are not coplanar with their surroundings
    int candidates_covered_ = 0;
};

void PixelCostSum::add(const Hit& hit) {
    const PixelState state = observed_.states[hit.index];
    const double cosine = std::abs(hit.normal.dot(hit.point)) / hit.point.norm();
    const double sensor_m = observed_.sigma_m[hit.index];
    const double sigma_m = std::sqrt(sensor_m * sensor_m + extra_variance_m2_);
    const double in_front_m = observed_.depth_m[hit.index] - hit.point.z();
    candidates_covered_ += state == PixelState::kCandidate;
    ++counts_.model_rays;
    const int agreeing = counts_.agreeing, contradicted = counts_.contradicted;
    const double deep = counts_.deep;
    const double weight = observed_.weight(hit.index);
    covered_weight_ += weight;
    const double cost = cost_of(in_front_m, in_front_m * cosine, sigma_m, state, weight);
    sum_ += cost;
    if (options_.with_outline && counts_.agreeing > agreeing) judge_edge(hit, weight, cost);
    if (observed_.at_step.empty() || !observed_.at_step[hit.index]) return;
    constexpr double kSurest = 0.98;
    const double mixed = std::min(kSurest, observed_.mixes_steps);
    counts_.mixed_agreeing += mixed * (counts_.agreeing - agreeing);
    counts_.mixed_contradicted += mixed * (counts_.contradicted - contradicted);
    counts_.deep -= mixed * (counts_.deep - deep);
}

// The cost of one ray that meets the model, and its count.
double PixelCostSum::cost_of(double in_front_m, double residual_m, double sigma_m, PixelState state, double weight) {
    const bool segmented = observed_.segmented;
    const double r = residual_m / (options_.truncation_sigmas * sigma_m);  // positive: the model is in front
    if (r > 1.0) {
        ++counts_.free_space_violations;
        ++counts_.contradicted;
        counts_.deep += deep_share(in_front_m, deep_m(sigma_m));
        return segmented ? 1.0 : free_space_cost(in_front_m, options_);
    }
    if (r < -1.0) {
        ++counts_.occluded;
        if (segmented && state == PixelState::kCandidate) {
            ++counts_.contradicted;
            return 1.0;
        }
        return segmented ? options_.occluded_cost : weight * options_.unexplained_cost;
    }
    if (state == PixelState::kBackground) {
        ++counts_.off_mask;
        return options_.occluded_cost;
    }
    ++counts_.agreeing;
    return weight * r * r;
}

// An agreeing ray beyond which the surface goes on is no evidence of the object.
void PixelCostSum::judge_edge(const Hit& hit, double weight, double cost) {
    const Edge edge = edge_at(hit, observed_, covered_, options_);
    counts_.outline += edge != Edge::kInterior;
    if (edge != Edge::kCoplanar) {
        explained_ += weight * options_.unexplained_cost - cost;
        return;
    }
    ++counts_.coplanar;
    if (observed_.segmented) return;
    --counts_.agreeing;
    sum_ += options_.outline_cost - cost;
}

PixelCost PixelCostSum::total() const {
    PixelCost result = counts_;
    double sum = sum_;
    // The larger the coplanar share of the outline, the less the rays within are evidence of the object.
    if (!observed_.segmented) sum += result.coplanar_share() * result.coplanar_share() * std::max(0.0, explained_);
    result.missing_model = observed_.num_candidates - candidates_covered_;
    result.gain = options_.unexplained_cost * covered_weight_ - sum;
    double missing = result.missing_model;
    if (!observed_.weights.empty()) missing = total_weight(observed_) - covered_weight_;
    sum += missing * (observed_.segmented ? 1.0 : options_.unexplained_cost);
    result.judged = result.model_rays + result.missing_model;
    result.cost = result.judged > 0 ? sum / result.judged : 1.0;
    return result;
}

}  // namespace

PixelCost pixel_cost(const View& view, const Pose& camera_from_object, const ObservedGrid& observed,
                     const PixelCostOptions& options) {
    const Eigen::Matrix3f rotation = camera_from_object.rotation_matrix().cast<float>();
    const Eigen::Vector3f translation = camera_from_object.translation.cast<float>();
    PixelCostSum sum(observed, options, options.with_outline ? covered_by(view, observed.grid) : std::vector<char>{});
    for (std::size_t k = 0; k < view.size(); ++k) {
        const int index = view.pixels[k];
        if (observed.states[index] == PixelState::kNoDepth) continue;
        Hit hit{rotation * view.points_in_object[k] + translation, rotation * view.normals_in_object[k], index};
        if (view.of_samples) hit.point = on_ray(hit, observed);
        sum.add(hit);
    }
    return sum.total();
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
