#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>

#include "apps/error_measures/frame_errors.hpp"

namespace nearpose::evaluation {

Visibility visibility_of(const std::vector<Eigen::Vector3f>& visible_points_in_camera) {
    Visibility visibility;
    if (visible_points_in_camera.empty()) return visibility;
    const auto count = static_cast<double>(visible_points_in_camera.size());
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3f& point : visible_points_in_camera) mean += point.cast<double>() / count;
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    for (const Eigen::Vector3f& point : visible_points_in_camera) {
        const Eigen::Vector3d offset = point.cast<double>() - mean;
        covariance += offset * offset.transpose() / count;
    }
    visibility.distance_m = mean.norm();
    // Two standard deviations hold nearly all of a surface's points. Rounding makes flat clouds slightly negative.
    constexpr double kDeviations = 2.0;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(covariance, Eigen::EigenvaluesOnly);
    const Eigen::Vector3d semi_axes_m = kDeviations * axes.eigenvalues().cwiseMax(0.0).cwiseSqrt();
    visibility.visible_volume_m3 = 4.0 / 3.0 * std::numbers::pi * semi_axes_m.prod();
    return visibility;
}

std::optional<Visibility> visibility_of(const DepthImage& depth, const Mask& visible, const PinholeCamera& camera) {
    std::vector<Eigen::Vector3f> points_in_camera;
    for (int pixel = 0; pixel < camera.width * camera.height; ++pixel) {
        const auto index = static_cast<std::size_t>(pixel);
        if (visible.value[index] == 0 || !(depth.depth_m[index] > 0.0F)) continue;
        const Eigen::Vector3d ray = camera.ray(pixel % camera.width, pixel / camera.width);
        points_in_camera.emplace_back((static_cast<double>(depth.depth_m[index]) * ray).cast<float>());
    }
    if (points_in_camera.empty()) return std::nullopt;
    return visibility_of(points_in_camera);
}

}  // namespace nearpose::evaluation
