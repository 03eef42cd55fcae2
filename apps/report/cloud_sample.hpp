// The measured points of a frame that the page shows.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/pose.hpp"
#include "core/observation/observation.hpp"
#include "raycast/embree_scene.hpp"

namespace nearpose::report {

struct CloudSample {
    std::vector<Eigen::Vector3f> points_in_camera;  // [m]; first those that may be the part, then the background
    std::size_t on_part = 0;                        // number of the first kind
    // For those on the part: how far behind the model at the estimate they lie along the camera's axis, in
    // kResidualUnit; kNoResidual where the model is not hit.
    std::vector<std::int16_t> residuals;
};

inline constexpr double kResidualUnitM = 1e-5;
inline constexpr std::int16_t kNoResidual = -32768;

// About `max_points` on the part and half as many around it, within `max_depth_m`.
CloudSample sample_cloud(const Observation& observation, const EmbreeScene& model,
                         const std::optional<Pose>& camera_from_object, int max_points, double max_depth_m);

}  // namespace nearpose::report
