// Cards that stand upright across the camera's axis, measured by stereo or structured light.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "apps/depth_sensor/stereo_sensor.hpp"

namespace nearpose::simulate {

inline const PinholeCamera kCamera{320, 240, 300.0, 300.0, 159.5, 119.5};

// From x = left_m to right_m and y = upper_m to lower_m in the left camera's axes.
struct Card {
    double depth_m, left_m = -10.0, right_m = 10.0, upper_m = -10.0, lower_m = 10.0;
};

inline RenderFrom cards(const std::vector<Card>& all) {
    return [all](const Pose& viewpoint_from_left, const PinholeCamera& camera) {
        const std::size_t count = static_cast<std::size_t>(camera.width) * camera.height;
        RenderedImage image{{camera.width, camera.height, std::vector<float>(count, 0.0F)},
                            std::vector<int>(count, -1),
                            std::vector<Eigen::Vector3f>(count, Eigen::Vector3f::Zero())};
        for (std::size_t pixel = 0; pixel < count; ++pixel) {
            const int u = static_cast<int>(pixel) % camera.width, v = static_cast<int>(pixel) / camera.width;
            for (const Card& card : all) {
                const double x_m = card.depth_m * camera.ray(u, v).x() - viewpoint_from_left.translation.x();
                const double y_m = card.depth_m * camera.ray(u, v).y();
                float& depth_m = image.depth.depth_m[pixel];
                if (x_m < card.left_m || x_m > card.right_m || y_m < card.upper_m || y_m > card.lower_m) continue;
                if (depth_m > 0.0F && card.depth_m > depth_m) continue;
                depth_m = static_cast<float>(card.depth_m);
                image.object[pixel] = 0;
                image.normals_in_camera[pixel] = -Eigen::Vector3f::UnitZ();
            }
        }
        return image;
    };
}

// Dots of two pixels, five pixels apart.
inline StereoRig test_rig() {
    StereoRig rig;
    rig.dots = 4000;
    rig.dot_sigma_tan = 0.0028;
    rig.projector_width_tan = 1.3;
    rig.projector_height_tan = 0.9;
    rig.min_range_m = 0.15;
    return rig;
}

inline DepthImage measured(const std::vector<Card>& all, const StereoRig& rig, std::uint64_t seed = 1,
                           std::uint64_t frame = 0) {
    return depth_of(infrared_images(cards(all), kCamera, rig, {}, 1, seed, frame), kCamera, rig);
}

inline double disparity_at(double depth_m) {
    return kCamera.fx * test_rig().baseline_m / depth_m;
}

// Errors of disparity [pixels] of the pixels that have depth, in the columns first_u <= u < last_u, borders left out.
inline std::vector<double> disparity_errors(const DepthImage& image, double depth_m, int first_u, int last_u) {
    std::vector<double> errors;
    for (int v = 10; v < kCamera.height - 10; ++v) {
        for (int u = first_u; u < last_u; ++u) {
            const float depth = image.depth_m[static_cast<std::size_t>(v * kCamera.width + u)];
            if (depth > 0.0F) errors.push_back(disparity_at(depth) - disparity_at(depth_m));
        }
    }
    return errors;
}

inline double quantile(std::vector<double> values, double share) {
    const auto place = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), place, values.end());
    return *place;
}

// Share of a row-wise band of pixels whose depth is near the given one.
inline double share_at(const DepthImage& image, double depth_m, int first_u, int last_u) {
    const std::vector<double> errors = disparity_errors(image, depth_m, first_u, last_u);
    const auto near = std::count_if(errors.begin(), errors.end(), [](double error) { return std::abs(error) < 1.0; });
    return static_cast<double>(near) / ((kCamera.height - 20) * (last_u - first_u));
}

}  // namespace nearpose::simulate
