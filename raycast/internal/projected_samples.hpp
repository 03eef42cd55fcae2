// Surface samples in a camera's image, and the view of those that are kept.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <vector>

#include "core/base/camera.hpp"
#include "core/base/pose.hpp"
#include "core/view_generator.hpp"
#include "raycast/surface_samples.hpp"

namespace nearpose {

struct ProjectedSample {
    Eigen::Vector3d point_in_camera = Eigen::Vector3d::Zero();  // [m]
    double u = 0.0, v = 0.0;                                    // [pixels]
    int sample = -1;
    int pixel = -1;  // -1: beside the image
};

// Keeps the nearest sample of each cell, the first where several are equally near.
struct NearestSamples {
    explicit NearestSamples(const PinholeCamera& camera)
        : depth_m(static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height),
                  std::numeric_limits<double>::infinity()),
          kept(depth_m.size(), -1) {}

    void draw(int cell, double sample_depth_m, int sample) {
        const auto i = static_cast<std::size_t>(cell);
        if (!(sample_depth_m < depth_m[i])) return;
        depth_m[i] = sample_depth_m;
        kept[i] = sample;
    }

    std::vector<double> depth_m;
    std::vector<int> kept;  // -1: nothing was drawn
};

// Throws std::invalid_argument if the pose or the camera is not valid.
void check_view(const Pose& camera_from_object, const PinholeCamera& camera);

// Calls `draw` with every sample before the camera that falls into the image, and with those whose distance to the
// image, at their depth, is at most `margin_m`.
template <typename Draw>
void project_samples(const SurfaceSamples& samples, const Pose& camera_from_object, const PinholeCamera& camera,
                     double margin_m, Draw draw) {
    const Eigen::Matrix3d rotation = camera_from_object.rotation_matrix();
    for (std::size_t i = 0; i < samples.points_in_object.size(); ++i) {
        const Eigen::Vector3d point =
            rotation * samples.points_in_object[i].cast<double>() + camera_from_object.translation;
        if (!(point.z() > 0.0)) continue;
        const Eigen::Vector2d uv = camera.project(point);
        const int pixel = camera.pixel_at(uv.x(), uv.y());
        if (pixel < 0) {
            const double beside_u = std::abs(uv.x() - 0.5 * (camera.width - 1)) - 0.5 * camera.width;
            const double beside_v = std::abs(uv.y() - 0.5 * (camera.height - 1)) - 0.5 * camera.height;
            if (!(beside_u * point.z() <= camera.fx * margin_m && beside_v * point.z() <= camera.fy * margin_m))
                continue;
            if (!(margin_m > 0.0)) continue;
        }
        draw(ProjectedSample{point, uv.x(), uv.y(), static_cast<int>(i), pixel});
    }
}

// The view of one sample a pixel, with normals turned towards the camera; -1 where there is none.
View view_of(const SurfaceSamples& samples, const std::vector<int>& sample_of_pixel, const Pose& camera_from_object);

}  // namespace nearpose
