// A depth camera's faults, applied to rendered depth. The defaults are those of a short-baseline stereo camera for
// close range.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/base/camera.hpp"
#include "core/base/depth_image.hpp"
#include "raycast/depth_renderer.hpp"

namespace nearpose::simulate {

struct SensorNoise {
    // Axial noise of a pixel: sigma = (sigma_floor_m + sigma_per_square_metre * (depth - sigma_least_at_m)^2) *
    // (1 + angle_factor * (a / (pi/2 - a))^2), a being the angle between the surface's normal and the ray (the form of
    // Nguyen et al. 2012). A matching window makes neighbours share it: white noise is smoothed with a Gaussian of
    // `correlation_pixels` and scaled back to sigma.
    double sigma_floor_m = 0.0005;           // [m]
    double sigma_per_square_metre = 0.0015;  // [m / m^2]
    double sigma_least_at_m = 0.0;           // [m]
    double angle_factor = 0.0;               // 0: the same at all angles
    double correlation_pixels = 0.8;         // 0: neighbours are independent

    // The surface that a pixel measures lies beside its own ray by this much in u and in v (standard deviation).
    double jitter_pixels = 0.5;

    // A smooth error of depth that stays the same over the whole sequence, as of an ill-calibrated camera.
    double bias_sigma_m = 0.0005;
    double bias_length_pixels = 40.0;  // spacing of the nodes between which it is interpolated

    // A smooth error like it, but another one in every frame.
    double frame_bias_sigma_m = 0.0;
    double frame_bias_length_pixels = 40.0;

    // All depths are too long by this part of themselves, or too short where it is negative.
    double depth_scale_error = 0.0;

    // Stereo: the second imager stands `baseline_m` to the right (0: no stereo). What it does not see has no depth:
    // shadows on the left of near objects and a band at the image's left border. Depth comes from a disparity in steps.
    double baseline_m = 0.018;
    double disparity_step_pixels = 1.0 / 32.0;  // 0: no steps

    // No depth on surfaces seen at a grazing angle: never below the first angle between the surface's normal and the
    // ray, with the given probability above the second, in patches.
    double grazing_begin_rad = 1.25;
    double grazing_end_rad = 1.52;
    double grazing_drop_probability = 1.0;
    double grazing_patch_pixels = 2.5;  // size of the patches

    // Highlights: a light `light_offset_m` to the right of the camera blinds it where a mirror in the surface's place
    // would throw the light into a pixel's ray within the given angle. Such pixels have no depth with the given
    // probability, in patches.
    double specular_angle_rad = 0.12;
    double specular_drop_probability = 0.0;
    double specular_patch_pixels = 6.0;
    double light_offset_m = 0.0;

    // An edge is where a pixel's surroundings depart from its surface by more than the jump.
    double edge_jump_m = 0.008;
    int edge_radius_pixels = 2;
    double edge_drop_probability = 0.35;  // a pixel at an edge has no depth
    double flying_probability = 0.15;     // a pixel at an edge lies between the two surfaces

    double min_range_m = 0.10;  // nearer and farther surfaces have no depth
    double max_range_m = 4.0;

    double sigma_m(double depth_m) const {
        const double far_m = depth_m - sigma_least_at_m;
        return sigma_floor_m + sigma_per_square_metre * far_m * far_m;
    }
    double sigma_m(double depth_m, double incidence_rad) const {
        // The form has no bound at pi/2, where nothing is measured anyway.
        const double angle = std::min(incidence_rad, 1.5);
        const double ratio = angle / (M_PI / 2 - angle);
        return sigma_m(depth_m) * (1.0 + angle_factor * ratio * ratio);
    }
};

// Throws std::invalid_argument naming field, value and bound.
void validate(const SensorNoise& noise);

// Every standard deviation, probability, step and the error of scale times `scale`; probabilities end at 1. Factors of
// standard deviations (angle_factor) stay. Scale 0 leaves the range alone: exact depth of every surface, without
// stereo's shadows.
SensorNoise scaled(SensorNoise noise, double scale);

// One camera: its fixed error field is drawn when it is constructed. Immutable; measure may be called from several
// threads at once. The same seed and frame give the same bits.
class DepthSensor {
  public:
    DepthSensor(const SensorNoise& noise, const PinholeCamera& camera, std::uint64_t seed);

    // `exact` must have been rendered with this sensor's camera. 0 where nothing is measured.
    DepthImage measure(const RenderedImage& exact, std::uint64_t frame) const;

    const std::vector<float>& bias_m() const { return bias_m_; }  // row-major, one a pixel

  private:
    SensorNoise noise_;
    PinholeCamera camera_;
    std::uint64_t seed_;
    std::vector<float> bias_m_;
};

}  // namespace nearpose::simulate
