// The depth sensor's noise, as the likelihood and the covariance use it.
#pragma once

namespace nearpose {

// Axial noise of a structured-light or stereo sensor grows with the square of the distance (the disparity's error is
// constant). On top of it every real sensor carries a smooth error field that neighbouring pixels share: averaging over
// pixels does not remove it, and a covariance that ignores it is far too small.
struct SensorModel {
    double sigma_floor_m = 0.0005;           // axial noise at contact [m]
    double sigma_per_square_metre = 0.0015;  // axial noise per squared distance [m / m^2]
    double systematic_sigma_m = 0.0005;      // of the shared error field [m]
    double systematic_length_pixels = 40.0;  // over which pixels share it [pixels of the image]
    double min_range_m = 0.03;               // nearer measurements are none [m]
    double max_range_m = 5.0;                // farther measurements are none [m]

    // Standard deviation of one pixel's depth along the optical axis, for a surface seen face on [m].
    double sigma_m(double depth_m) const { return sigma_floor_m + sigma_per_square_metre * depth_m * depth_m; }
};

// Throws std::invalid_argument naming field, value and bound.
void validate(const SensorModel& sensor);

}  // namespace nearpose
