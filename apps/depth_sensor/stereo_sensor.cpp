#include "apps/depth_sensor/stereo_sensor.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "apps/base/simulation_draws.hpp"

namespace nearpose::simulate {
namespace {

constexpr Material kGreyPaint{0.5, 0.05, 10.0};

// What lights the scene.
struct Lighting {
    double ambient;
    DotProjector projector;
};

// Light that a surface point throws to a camera. Point, normal and camera are in the left camera's axes.
double brightness(const Eigen::Vector3d& point, const Eigen::Vector3d& normal, const Eigen::Vector3d& camera_position,
                  const Material& material, const Lighting& lighting) {
    const double even = lighting.ambient * material.albedo;
    const double dots = lighting.projector.light_at(point);
    if (dots == 0.0) return even;
    const Eigen::Vector3d to_light = (lighting.projector.position_in_left() - point).normalized();
    const double cosine = normal.dot(to_light);
    if (cosine <= 0.0) return even;
    const Eigen::Vector3d to_camera = (camera_position - point).normalized();
    const double half = std::max(0.0, normal.dot((to_light + to_camera).normalized()));
    return even + dots * (material.albedo * cosine + material.highlight * std::pow(half, material.sharpness));
}

// The camera with `side` rays along each side of a pixel, each a pixel of its own.
PinholeCamera refined(const PinholeCamera& camera, int side) {
    return {camera.width * side, camera.height * side,           camera.fx * side,
            camera.fy * side,    (camera.cx + 0.5) * side - 0.5, (camera.cy + 0.5) * side - 0.5};
}

// Light in every pixel: the mean of what `light_of(u, v)` gives for the pixels of the refined camera.
template <typename LightOf>
std::vector<float> mean_of_rays(const PinholeCamera& camera, int side, const LightOf& light_of) {
    const float share = 1.0F / static_cast<float>(side * side);
    std::vector<float> light(static_cast<std::size_t>(camera.width) * camera.height, 0.0F);
    for (int v = 0; v < camera.height * side; ++v)
        for (int u = 0; u < camera.width * side; ++u)
            light[static_cast<std::size_t>(v / side) * camera.width + u / side] +=
                share * static_cast<float>(light_of(u, v));
    return light;
}

// Light in every pixel of the camera that stands `right_m` to the right of the left one.
std::vector<float> light_in(double right_m, const RenderFrom& render, const PinholeCamera& camera, int rays_per_pixel,
                            const Lighting& lighting, const Material& material, int num_parts) {
    const PinholeCamera rays = refined(camera, rays_per_pixel);
    const Eigen::Vector3d position(right_m, 0.0, 0.0);
    const RenderedImage image = render({Eigen::Quaterniond::Identity(), -position}, rays);
    return mean_of_rays(camera, rays_per_pixel, [&](int u, int v) {
        const std::size_t ray = static_cast<std::size_t>(v) * rays.width + u;
        const double depth_m = image.depth.depth_m[ray];
        if (depth_m == 0.0) return 0.0;
        const Eigen::Vector3d point = depth_m * rays.ray(u, v) + position;
        const Material& surface = image.object[ray] < num_parts ? material : kGreyPaint;
        return brightness(point, image.normals_in_camera[ray].cast<double>(), position, surface, lighting);
    });
}

// Weights of a Gaussian, from the middle on; with those of both sides they sum to 1.
std::vector<float> half_kernel(double sigma_pixels) {
    std::vector<float> weights{1.0F};
    float total = 1.0F;
    for (int k = 1; k <= static_cast<int>(std::ceil(3.0 * sigma_pixels)); ++k) {
        weights.push_back(static_cast<float>(std::exp(-0.5 * k * k / (sigma_pixels * sigma_pixels))));
        total += 2.0F * weights.back();
    }
    for (float& weight : weights) weight /= total;
    return weights;
}

// Convolved along rows or along columns; the border's values go on beyond it.
std::vector<float> blurred_along(const std::vector<float>& image, const PinholeCamera& camera, bool rows,
                                 const std::vector<float>& kernel) {
    std::vector<float> result(image.size());
    const auto value = [&](int u, int v) {
        return image[static_cast<std::size_t>(std::clamp(v, 0, camera.height - 1)) * camera.width +
                     std::clamp(u, 0, camera.width - 1)];
    };
    for (int v = 0; v < camera.height; ++v) {
        for (int u = 0; u < camera.width; ++u) {
            float sum = kernel[0] * value(u, v);
            for (int k = 1; k < static_cast<int>(kernel.size()); ++k) {
                const float sides = rows ? value(u - k, v) + value(u + k, v) : value(u, v - k) + value(u, v + k);
                sum += kernel[static_cast<std::size_t>(k)] * sides;
            }
            result[static_cast<std::size_t>(v) * camera.width + u] = sum;
        }
    }
    return result;
}

// Auto exposure: grey levels per light at which the brightest pixels but a few come near the end of the scale.
double exposure(const std::vector<float>& light) {
    constexpr double kShare = 0.95, kLevel = 200.0;
    std::vector<float> lit;
    for (const float value : light)
        if (value > 0.0F) lit.push_back(value);
    if (lit.empty()) return 1.0;
    const auto place = lit.begin() + static_cast<std::ptrdiff_t>(kShare * static_cast<double>(lit.size() - 1));
    std::nth_element(lit.begin(), place, lit.end());
    return kLevel / static_cast<double>(*place);
}

// The largest that is tried [pixels].
int max_disparity(const PinholeCamera& camera, const StereoRig& rig) {
    return std::min(camera.width, static_cast<int>(std::ceil(camera.fx * rig.baseline_m / rig.min_range_m)));
}

// Grey levels with their noise.
GreyImage exposed(const std::vector<float>& light, double gain, const PinholeCamera& camera, double sigma_grey,
                  std::uint64_t seed, std::uint64_t frame, RandomPurpose purpose) {
    GreyImage image{camera.width, camera.height, std::vector<std::uint8_t>(light.size())};
    for (std::size_t pixel = 0; pixel < light.size(); ++pixel) {
        const double noise = sigma_grey > 0.0 ? sigma_grey * RandomStream(seed, frame, pixel, purpose).gaussian() : 0.0;
        image.value[pixel] = static_cast<std::uint8_t>(
            std::lround(std::clamp(gain * static_cast<double>(light[pixel]) + noise, 0.0, 255.0)));
    }
    return image;
}

// The pattern as a camera at the projector would see it, on a surface that throws all of it back.
GreyImage reference_image(const PinholeCamera& camera, const StereoRig& rig, const std::vector<float>& kernel,
                          std::uint64_t seed) {
    const int more = max_disparity(camera, rig);
    const PinholeCamera wide{camera.width + more, camera.height, camera.fx, camera.fy, camera.cx + more, camera.cy};
    const PinholeCamera rays = refined(wide, rig.rays_per_pixel);
    const DotPattern pattern(rig, seed);
    const std::vector<float> sharp = mean_of_rays(wide, rig.rays_per_pixel, [&](int u, int v) {
        const Eigen::Vector3d ray = rays.ray(u, v);
        return pattern.at(ray.x(), ray.y());
    });
    const std::vector<float> light = blurred_along(blurred_along(sharp, wide, true, kernel), wide, false, kernel);
    return exposed(light, exposure(light), wide, 0.0, seed, 0, kRightInfraredDraw);
}

}  // namespace

InfraredPair infrared_images(const RenderFrom& render, const PinholeCamera& camera, const StereoRig& rig,
                             const Material& material, int num_parts, std::uint64_t seed, std::uint64_t frame) {
    const Lighting lighting{rig.ambient, DotProjector(render, camera, rig, seed)};
    const std::vector<float> kernel = half_kernel(rig.blur_pixels);
    const auto seen_from = [&](double right_m) {
        const std::vector<float> light =
            light_in(right_m, render, camera, rig.rays_per_pixel, lighting, material, num_parts);
        return blurred_along(blurred_along(light, camera, true, kernel), camera, false, kernel);
    };
    const std::vector<float> left = seen_from(0.0);
    const double gain = exposure(left);  // of both, as the cameras' common exposure
    GreyImage left_image = exposed(left, gain, camera, rig.infrared_sigma_grey, seed, frame, kLeftInfraredDraw);
    if (rig.structured_light) return {std::move(left_image), reference_image(camera, rig, kernel, seed)};
    return {std::move(left_image),
            exposed(seen_from(rig.baseline_m), gain, camera, rig.infrared_sigma_grey, seed, frame, kRightInfraredDraw)};
}

DepthImage depth_of(const InfraredPair& images, const PinholeCamera& camera, const StereoRig& rig) {
    const double pixels_times_m = camera.fx * rig.baseline_m;
    const std::vector<float> disparities = match(images.left, images.right, max_disparity(camera, rig), rig);
    DepthImage depth{camera.width, camera.height, std::vector<float>(disparities.size(), 0.0F)};
    for (std::size_t pixel = 0; pixel < disparities.size(); ++pixel) {
        if (!(disparities[pixel] > 0.0F)) continue;
        const double depth_m = pixels_times_m / static_cast<double>(disparities[pixel]);
        if (depth_m >= rig.min_range_m && depth_m <= rig.max_range_m)
            depth.depth_m[pixel] = static_cast<float>(depth_m);
    }
    return depth;
}

}  // namespace nearpose::simulate
