// Frames of a flat wall, and the plane that each of them shows.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <stdexcept>

#include "apps/depth_sensor/sensor_noise.hpp"
#include "core/base/camera.hpp"
#include "core/base/depth_image.hpp"

namespace nearpose::simulate {

struct WallFrame {
    int id = 0;
    PinholeCamera camera;
    DepthImage depth;
};

// The points X in front of the camera with inverse_m . X = 1. Of a ray with z = 1 the depth is then 1 / (inverse_m .
// ray): inverse depth is linear in the pixel's coordinates.
struct WallPlane {
    Eigen::Vector3d inverse_m = Eigen::Vector3d::UnitZ();  // in camera coordinates [1/m]

    double depth_m(const Eigen::Vector3d& ray) const { return 1.0 / inverse_m.dot(ray); }
    double angle_rad(const Eigen::Vector3d& ray) const;  // between its normal and the ray
};

// What is taken for granted of the sensor while its axial noise is being found.
struct WallSensor {
    SensorNoise noise;
    double count_m = 0.0;  // step of the depth's counts [m]; 0: none
};

// Variance of a pixel's depth on the plane [m^2] by what changes from frame to frame, but is no axial noise: jitter,
// the frame's own smooth error, and the steps of disparity and counts.
double other_variance(const WallSensor& sensor, const PinholeCamera& camera, const WallPlane& plane, double depth_m);

// Standard deviation of a pixel's depth on the plane, all taken together [m]; never 0.
double expected_sigma_m(const WallSensor& sensor, const PinholeCamera& camera, const WallPlane& plane,
                        const Eigen::Vector3d& ray);

struct WallFit {
    WallPlane plane;
    int pixels = 0;                 // with depth, in the region
    double rms_m = 0.0;             // robust: 1.48 times the median of the residuals' sizes
    double expected_m = 0.0;        // the median of expected_sigma_m
    double outlier_share = 0.0;     // pixels beyond 6 times the frame's own spread, or behind no plane at all
    double structured_share = 0.0;  // part of the inliers' variance that means over 8 x 8 pixels keep: 1/64 for white
                                    // noise, near 1 where the surface itself departs from the plane
};

// The whole image, or the region's part of it.
PixelBox region_of(const PinholeCamera& camera, const std::optional<PixelBox>& region);

// The plane by iteratively reweighted least squares: Huber's weights first, for a start that outliers do not own, then
// Tukey's. nullopt where fewer than `min_pixels` have depth.
std::optional<WallFit> fit_wall_plane(const WallFrame& frame, const PixelBox& region, const WallSensor& sensor,
                                      int min_pixels);

// The frame's residuals in expected standard deviations: their robust spread. 1 where the sensor is as expected.
double robust_spread(const WallFrame& frame, const PixelBox& region, const WallPlane& plane, const WallSensor& sensor);

// Whether a pixel's residual [m] is no noise, for a frame of that spread.
bool is_outlier(double residual_m, double expected_m, double spread, double step_m);

// The largest step between neighbouring values of depth there [m].
double depth_step_m(const WallSensor& sensor, const PinholeCamera& camera, double depth_m);

}  // namespace nearpose::simulate
