#include "apps/depth_sensor/sensor_noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>

#include "apps/base/simulation_draws.hpp"
#include "apps/depth_sensor/noise_field.hpp"
#include "core/base/check.hpp"

namespace nearpose::simulate {
namespace {

// The exact image with what is asked of it for every pixel.
struct ExactImage {
    const RenderedImage& image;
    const PinholeCamera& camera;

    float depth(int pixel) const { return image.depth.depth_m[static_cast<std::size_t>(pixel)]; }
    // Depth at (u, v) [pixels] of the plane that touches the surface at `pixel`; the depth there where the plane is
    // seen so flat that the answer would run away.
    double plane_depth(int pixel, double u, double v) const {
        const Eigen::Vector3d normal = image.normals_in_camera[static_cast<std::size_t>(pixel)].cast<double>();
        const double distance = normal.dot(camera.ray(pixel % camera.width, pixel / camera.width)) * depth(pixel);
        const double slope = normal.dot(camera.ray(u, v));
        if (!(std::abs(slope) > 0.02)) return depth(pixel);
        return distance / slope;
    }
    // Cosine of the angle between the surface's normal and the ray.
    double incidence_cosine(int pixel) const {
        const Eigen::Vector3d ray = camera.ray(pixel % camera.width, pixel / camera.width);
        return std::abs(image.normals_in_camera[static_cast<std::size_t>(pixel)].cast<double>().dot(ray)) / ray.norm();
    }
};

// Depth of what stands out most from the surface at `pixel` in its surroundings: 0 for nothing there at all, negative
// where there is no edge.
float depth_across_edge(const ExactImage& exact, int pixel, const SensorNoise& noise) {
    constexpr std::array<std::array<int, 2>, 8> kDirections{
        {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {1, -1}, {-1, 1}, {-1, -1}}};
    const int width = exact.camera.width, height = exact.camera.height;
    const int u = pixel % width, v = pixel / width;
    double strongest_m = noise.edge_jump_m;
    float found = -1.0F;
    for (const auto& [du, dv] : kDirections) {
        const int other_u = u + du * noise.edge_radius_pixels, other_v = v + dv * noise.edge_radius_pixels;
        if (other_u < 0 || other_v < 0 || other_u >= width || other_v >= height) continue;
        const float other = exact.depth(other_v * width + other_u);
        if (other == 0.0F) return 0.0F;
        // Steep planes change much from pixel to pixel, but are no edges.
        if (std::abs(other - exact.depth(pixel)) <= noise.edge_jump_m) continue;
        const double jump_m = std::abs(other - exact.plane_depth(pixel, other_u, other_v));
        if (jump_m <= strongest_m) continue;
        strongest_m = jump_m;
        found = other;
    }
    return found;
}

// Pixels that the second imager does not see. Point (u, z) appears there at u - fx * baseline / z; what a point farther
// to the right covers by then is hidden.
std::vector<char> stereo_shadow(const ExactImage& exact, double baseline_m) {
    const PinholeCamera& camera = exact.camera;
    std::vector<char> hidden(exact.image.depth.depth_m.size(), 0);
    if (baseline_m == 0.0) return hidden;
    for (int v = 0; v < camera.height; ++v) {
        double covered_from = std::numeric_limits<double>::infinity();
        for (int u = camera.width - 1; u >= 0; --u) {
            const int pixel = v * camera.width + u;
            if (exact.depth(pixel) == 0.0F) continue;
            const double there = u - camera.fx * baseline_m / exact.depth(pixel);
            hidden[static_cast<std::size_t>(pixel)] = there < -0.5 || there >= covered_from;
            covered_from = std::min(covered_from, there);
        }
    }
    return hidden;
}

// Probability that a standard Gaussian lies below `value`: turns shared Gaussian noise into a shared uniform draw.
double uniform_of(double value) {
    return 0.5 * std::erfc(-value / std::sqrt(2.0));
}

bool dropped_for_grazing(const SensorNoise& noise, double incidence_cosine, double gaussian) {
    const double begin = std::cos(noise.grazing_begin_rad), end = std::cos(noise.grazing_end_rad);
    if (incidence_cosine >= begin) return false;
    const double t = std::min(1.0, (begin - incidence_cosine) / (begin - end));
    return uniform_of(gaussian) < noise.grazing_drop_probability * t * t * (3.0 - 2.0 * t);
}

// Whether a mirror that touches the surface at `pixel` throws the light near the pixel's ray. The normal's sign does
// not matter.
bool in_highlight(const SensorNoise& noise, const ExactImage& exact, int pixel) {
    const Eigen::Vector3d ray = exact.camera.ray(pixel % exact.camera.width, pixel / exact.camera.width);
    const Eigen::Vector3d point = ray * static_cast<double>(exact.depth(pixel));
    const Eigen::Vector3d to_light = (Eigen::Vector3d(noise.light_offset_m, 0.0, 0.0) - point).normalized();
    const Eigen::Vector3d normal = exact.image.normals_in_camera[static_cast<std::size_t>(pixel)].cast<double>();
    const Eigen::Vector3d mirrored = 2.0 * normal.dot(to_light) * normal - to_light;
    return mirrored.dot(-ray.normalized()) >= std::cos(noise.specular_angle_rad);
}

// Depth in whole steps of disparity.
double in_disparity_steps(double depth_m, double fx_times_baseline, double step_pixels) {
    if (fx_times_baseline == 0.0 || step_pixels == 0.0) return depth_m;
    const double steps = std::round(fx_times_baseline / depth_m / step_pixels);
    return steps < 1.0 ? 0.0 : fx_times_baseline / (steps * step_pixels);
}

// Gaussian draws of one frame, one a pixel, that neighbouring pixels share.
struct FrameDraws {
    std::vector<Eigen::Array4f> shared;  // axial noise, jitter in u, jitter in v, drop-outs at edges
    std::vector<float> patches;          // drop-outs at grazing angles
    std::vector<float> highlights;       // drop-outs in highlights; empty where the sensor has none
    std::vector<float> bias;             // the frame's own error field; empty where the sensor has none
};

FrameDraws draw_frame(const SensorNoise& noise, const PinholeCamera& camera, std::uint64_t seed, std::uint64_t frame) {
    FrameDraws draws;
    draws.shared = correlated_noise(camera.width, camera.height, noise.correlation_pixels, seed, frame, kPixelDraw);
    draws.patches = smooth_field(camera.width, camera.height, noise.grazing_patch_pixels, seed, frame, kPatchDraw);
    if (noise.specular_drop_probability > 0.0) {
        draws.highlights =
            smooth_field(camera.width, camera.height, noise.specular_patch_pixels, seed, frame, kSpecularDraw);
    }
    if (noise.frame_bias_sigma_m > 0.0) {
        draws.bias =
            smooth_field(camera.width, camera.height, noise.frame_bias_length_pixels, seed, frame, kFrameBiasDraw);
    }
    return draws;
}

// Whether the surface at `seen` gives the pixel `index` no depth: it is seen too flat, or blinds the camera.
bool gives_no_depth(const SensorNoise& noise, const ExactImage& exact, const FrameDraws& draws, std::size_t index,
                    int seen) {
    if (dropped_for_grazing(noise, exact.incidence_cosine(seen), draws.patches[index])) return true;
    return !draws.highlights.empty() && in_highlight(noise, exact, seen) &&
           uniform_of(draws.highlights[index]) < noise.specular_drop_probability;
}

// Depth of the surface at `seen` where the ray through (u, v) meets it [m]. At an edge it may be missing, or lie
// between the two surfaces.
std::optional<double> surface_depth(const SensorNoise& noise, const ExactImage& exact, int seen, double u, double v,
                                    double edge_draw, RandomStream chance) {
    double depth_m = exact.plane_depth(seen, u, v);
    const float across_edge_m = depth_across_edge(exact, seen, noise);
    if (across_edge_m >= 0.0F) {
        if (uniform_of(edge_draw) < noise.edge_drop_probability) return std::nullopt;
        const bool flies = chance.uniform() < noise.flying_probability;
        if (flies && across_edge_m > 0.0F) depth_m += chance.uniform() * (across_edge_m - depth_m);
    }
    return depth_m;
}

}  // namespace

void validate(const SensorNoise& noise) {
    check_option("sensor.sigma_floor_m", noise.sigma_floor_m, 0.0, 1.0);
    check_option("sensor.sigma_per_square_metre", noise.sigma_per_square_metre, 0.0, 1.0);
    check_option("sensor.sigma_least_at_m", noise.sigma_least_at_m, 0.0, 10.0);
    check_option("sensor.angle_factor", noise.angle_factor, 0.0, 10.0);
    check_option("sensor.correlation_pixels", noise.correlation_pixels, 0.0, 20.0);
    check_option("sensor.jitter_pixels", noise.jitter_pixels, 0.0, 100.0);
    check_option("sensor.bias_sigma_m", noise.bias_sigma_m, 0.0, 1.0);
    check_option("sensor.bias_length_pixels", noise.bias_length_pixels, 2.0, 1e4);
    check_option("sensor.frame_bias_sigma_m", noise.frame_bias_sigma_m, 0.0, 1.0);
    check_option("sensor.frame_bias_length_pixels", noise.frame_bias_length_pixels, 2.0, 1e4);
    check_option("sensor.depth_scale_error", noise.depth_scale_error, -0.9, 10.0);
    check_option("sensor.baseline_m", noise.baseline_m, 0.0, 10.0);
    check_option("sensor.disparity_step_pixels", noise.disparity_step_pixels, 0.0, 10.0);
    check_option("sensor.grazing_begin_rad", noise.grazing_begin_rad, 0.0, M_PI / 2);
    check_option("sensor.grazing_end_rad", noise.grazing_end_rad, noise.grazing_begin_rad + 1e-6, M_PI / 2);
    check_option("sensor.grazing_drop_probability", noise.grazing_drop_probability, 0.0, 1.0);
    check_option("sensor.grazing_patch_pixels", noise.grazing_patch_pixels, 1.0, 1e4);
    check_option("sensor.specular_angle_rad", noise.specular_angle_rad, 0.0, M_PI / 2);
    check_option("sensor.specular_drop_probability", noise.specular_drop_probability, 0.0, 1.0);
    check_option("sensor.specular_patch_pixels", noise.specular_patch_pixels, 1.0, 1e4);
    check_option("sensor.light_offset_m", noise.light_offset_m, -10.0, 10.0);
    check_option("sensor.edge_jump_m", noise.edge_jump_m, 1e-6, 10.0);
    check_option("sensor.edge_radius_pixels", noise.edge_radius_pixels, 1, 20);
    check_option("sensor.edge_drop_probability", noise.edge_drop_probability, 0.0, 1.0);
    check_option("sensor.flying_probability", noise.flying_probability, 0.0, 1.0);
    check_option("sensor.min_range_m", noise.min_range_m, 0.001, 1e3);
    check_option("sensor.max_range_m", noise.max_range_m, noise.min_range_m, 1e3);
}

SensorNoise scaled(SensorNoise noise, double scale) {
    check_option("noise scale", scale, 0.0, 100.0);
    for (double* size : {&noise.sigma_floor_m, &noise.sigma_per_square_metre, &noise.jitter_pixels, &noise.bias_sigma_m,
                         &noise.frame_bias_sigma_m, &noise.depth_scale_error, &noise.disparity_step_pixels}) {
        *size *= scale;
    }
    for (double* probability : {&noise.grazing_drop_probability, &noise.specular_drop_probability,
                                &noise.edge_drop_probability, &noise.flying_probability}) {
        *probability = std::min(1.0, *probability * scale);
    }
    if (scale == 0.0) noise.baseline_m = 0.0;
    return noise;
}

DepthSensor::DepthSensor(const SensorNoise& noise, const PinholeCamera& camera, std::uint64_t seed)
    : noise_(noise), camera_(camera), seed_(seed) {
    validate(noise);
    validate(camera);
    bias_m_ = smooth_field(camera.width, camera.height, noise.bias_length_pixels, seed, 0, kBiasDraw);
    for (float& bias : bias_m_) bias *= static_cast<float>(noise.bias_sigma_m);
}

DepthImage DepthSensor::measure(const RenderedImage& exact_image, std::uint64_t frame) const {
    if (exact_image.depth.width != camera_.width || exact_image.depth.height != camera_.height) {
        throw std::invalid_argument("measure: the image is not of the sensor's size");
    }
    const ExactImage exact{exact_image, camera_};
    const FrameDraws draws = draw_frame(noise_, camera_, seed_, frame);
    const std::vector<char> hidden = stereo_shadow(exact, noise_.baseline_m);
    DepthImage measured{camera_.width, camera_.height, std::vector<float>(exact_image.depth.depth_m.size(), 0.0F)};
    for (int pixel = 0; pixel < camera_.width * camera_.height; ++pixel) {
        const auto index = static_cast<std::size_t>(pixel);
        const Eigen::Array4f& draw = draws.shared[index];
        const double u = pixel % camera_.width + noise_.jitter_pixels * draw[1];
        const double v = pixel / camera_.width + noise_.jitter_pixels * draw[2];
        // The pixel whose surface is measured; at the image's border the surface is taken to go on.
        const int seen =
            camera_.pixel_at(std::clamp(u, 0.0, camera_.width - 1.0), std::clamp(v, 0.0, camera_.height - 1.0));
        if (exact.depth(seen) == 0.0F || hidden[static_cast<std::size_t>(seen)] != 0) continue;
        if (gives_no_depth(noise_, exact, draws, index, seen)) continue;
        const std::optional<double> surface_m =
            surface_depth(noise_, exact, seen, u, v, draw[3], RandomStream(seed_, frame, index, kPixelEventDraw));
        if (!surface_m) continue;
        const double sigma_m = noise_.angle_factor == 0.0
                                   ? noise_.sigma_m(*surface_m)
                                   : noise_.sigma_m(*surface_m, std::acos(std::min(1.0, exact.incidence_cosine(seen))));
        double depth_m = *surface_m * (1.0 + noise_.depth_scale_error);
        depth_m += sigma_m * draw[0] + bias_m_[index];
        if (!draws.bias.empty()) depth_m += noise_.frame_bias_sigma_m * draws.bias[index];
        depth_m = in_disparity_steps(depth_m, camera_.fx * noise_.baseline_m, noise_.disparity_step_pixels);
        if (!(depth_m >= noise_.min_range_m && depth_m <= noise_.max_range_m)) continue;
        measured.depth_m[index] = static_cast<float>(depth_m);
    }
    return measured;
}

}  // namespace nearpose::simulate
