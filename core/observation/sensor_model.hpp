// The depth sensor's noise, as the likelihood and the covariance use it.
#pragma once

namespace nearpose {

// Axial noise of a structured-light or stereo sensor grows with the square of the distance (the disparity's error is
// constant). On top of it every real sensor has errors that neighbouring pixels share: a smooth field over the image
// and a wrong scale. Averaging over pixels does not remove them, and a covariance that ignores them is far too small;
// they are unknowns beside the pose (see core/fit/joint_fit.hpp). The defaults are wide enough for the usual depth
// cameras.
struct SensorModel {
    double sigma_floor_m = 0.0005;            // axial noise at contact [m]
    double sigma_per_square_metre = 0.0015;   // axial noise per squared distance [m / m^2]
    double lateral_sigma_pixels = 0.6;        // a pixel measures the surface so far beside its own ray
    double systematic_sigma_m = 0.0005;       // of the smooth error field [m]
    double systematic_length_pixels = 40.0;   // over which pixels share it [pixels of the image]
    double systematic_fine_sigma_m = 0.0005;  // of what is shared over a quarter of that length [m]
    double depth_scale_sigma = 0.003;         // of the relative error that all depths share
    double focal_length_sigma = 0.001;        // of the calibration's relative error
    // Of a shift of the whole image against its calibration: of the principal point, and of edges, which a sensor moves
    // that gives one value for a window. Counts where neighbours share noise (Observation::shared_noise) [pixels].
    double image_shift_sigma_pixels = 0.5;
    // A sensor gives one value for a window of pixels. Within so many pixels of a depth step the window mixes two
    // surfaces or prefers the nearer one: the noise there is larger by the factor. 1: edges are as sharp as all else.
    double edge_pixels = 4.0;  // [pixels of the image]
    double edge_sigma_factor = 3.2;
    double edge_step_sigmas = 1.5;  // a smaller departure from the tangent plane is no step
    // By these fractions of their standard deviations the errors are free in the joint fit. Errors of the CAD and of
    // edges look like them, and a fit that may explain everything by the sensor follows the smallest features.
    double systematic_fitted = 0.5;
    double scale_fitted = 0.17;
    double min_range_m = 0.03;  // nearer measurements are none [m]
    double max_range_m = 5.0;   // farther measurements are none [m]

    // Over which pixels share the fine errors [pixels of the image].
    double fine_length_pixels() const { return 0.25 * systematic_length_pixels; }

    // Standard deviation of one pixel's depth along the optical axis, for a surface seen face on [m].
    double sigma_m(double depth_m) const { return sigma_floor_m + sigma_per_square_metre * depth_m * depth_m; }

    // Variance of the distance between a measured point and the surface's plane, along its normal: the axial noise
    // counts with the cosine of its angle to the normal, the lateral one with the sine [m^2]. `axial_m` is
    // Observation::sigma_m(depth_m); `normal_z` the normal's component along the optical
    // axis.
    double variance_along_normal_m2(double axial_m, double depth_m, double normal_z, double focal_pixels) const {
        const double lateral_m = lateral_sigma_pixels * depth_m / focal_pixels;
        const double squared_cosine = normal_z * normal_z;
        return axial_m * axial_m * squared_cosine + lateral_m * lateral_m * (1.0 - squared_cosine);
    }
};

// Throws std::invalid_argument naming field, value and bound.
void validate(const SensorModel& sensor);

}  // namespace nearpose
