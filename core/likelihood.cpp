#include "core/likelihood.hpp"

#include <cmath>

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

// The cost of one ray that meets the model, and its count.
double cost_of_hit(double residual_m, double sigma_m, PixelState state, bool segmented, const PixelCostOptions& options,
                   PixelCost& counts) {
    const double r = residual_m / (options.truncation_sigmas * sigma_m);  // positive: the model is in front
    if (r > 1.0) {
        ++counts.model_in_front;
        return 1.0;
    }
    if (r < -1.0) {
        ++counts.model_behind;
        if (segmented && state == PixelState::kCandidate) return 1.0;
        return segmented ? options.occluded_cost : options.unexplained_cost;
    }
    if (state == PixelState::kBackground) return options.occluded_cost;
    ++counts.agreeing;
    return r * r;
}

}  // namespace

PixelCost pixel_cost(const View& view, const Pose& camera_from_object, const ObservedGrid& observed,
                     const PixelCostOptions& options) {
    const Eigen::Matrix3f rotation = camera_from_object.rotation_matrix().cast<float>();
    const Eigen::Vector3f translation = camera_from_object.translation.cast<float>();
    const double extra_variance_m2 = options.extra_sigma_m * options.extra_sigma_m;
    PixelCost result;
    double sum = 0.0;
    int candidates_covered = 0;
    for (std::size_t k = 0; k < view.size(); ++k) {
        const int index = view.pixels[k];
        const PixelState state = observed.states[index];
        if (state == PixelState::kNoDepth) continue;
        const Eigen::Vector3f point = rotation * view.points_in_object[k] + translation;
        const Eigen::Vector3f normal = rotation * view.normals_in_object[k];
        const double cosine = std::abs(normal.dot(point)) / point.norm();
        const double sensor_m = observed.sigma_m[index];
        const double sigma_m = std::sqrt(sensor_m * sensor_m + extra_variance_m2);
        const double residual_m = (observed.depth_m[index] - point.z()) * cosine;
        sum += cost_of_hit(residual_m, sigma_m, state, observed.segmented, options, result);
        candidates_covered += state == PixelState::kCandidate;
        ++result.model_rays;
    }
    result.missing_model = observed.num_candidates - candidates_covered;
    sum += result.missing_model * (observed.segmented ? 1.0 : options.unexplained_cost);
    result.judged = result.model_rays + result.missing_model;
    result.cost = result.judged > 0 ? sum / result.judged : 1.0;
    return result;
}

double negative_log_likelihood(const PixelCost& cost, const PixelCostOptions& options) {
    return 0.5 * options.independent_rays * options.truncation_sigmas * options.truncation_sigmas * cost.cost;
}

}  // namespace nearpose
