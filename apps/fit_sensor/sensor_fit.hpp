// The axial part of a sensor's figures, fitted to frames of a flat wall.
//
// A frame's wall is a plane, and what its pixels depart from it is noise, fixed error, or the wall's own unevenness.
// Where several frames show the wall from one pose, a pixel's mean over them is the fixed part and the scatter about it
// is noise; with one frame a pose the two cannot be told apart. Figures that a wall does not show (jitter, steps of
// disparity, a frame's own smooth error) are taken as they are in the base, and the scatter that they explain is not
// laid to the axial noise.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apps/depth_sensor/sensor_noise.hpp"
#include "apps/fit_sensor/wall_plane.hpp"

namespace nearpose::simulate {

struct SensorFitOptions {
    std::optional<PixelBox> region;  // else the whole image
    double same_pose_m =
        0.002;             // planes are of one pose where they differ by less, at the depth of the region's middle
    int min_pixels = 500;  // of a frame, with depth
    double max_rms_ratio = 5.0;  // of structured residuals, to what is expected
    double max_outlier_share = 0.3;
};

struct FittedFigure {
    double value = 0.0;
    double low = 0.0, high = 0.0;  // 95 % interval
    bool fitted = false;           // false: the base's value, which the frames do not determine
};

// Pixels of one pose, of like depth and angle.
struct NoiseCell {
    int group = 0;
    double depth_m = 0.0;
    double angle_rad = 0.0;
    double depth_term = 0.0;      // mean of (depth - sigma_least_at_m)^2 [m^2]
    double angle_term = 0.0;      // mean of (a / (pi/2 - a))^2
    double other_variance = 0.0;  // see wall_plane.hpp [m^2]
    double sigma_m = 0.0;         // of the scatter, all taken together
    double freedom = 0.0;         // squares that it is the mean of, less the means that were taken off
    double effective = 0.0;       // as many independent ones; neighbouring pixels share noise
};

// All that was seen from one pose.
struct WallGroup {
    int frames = 0;
    int pixels = 0;  // with depth in at least one frame, two where noise and fixed error are separated
    double depth_m = 0.0, min_depth_m = 0.0, max_depth_m = 0.0;
    double angle_rad = 0.0, min_angle_rad = 0.0, max_angle_rad = 0.0;
    double sigma_m = 0.0;         // of the scatter, all taken together
    double fitted_sigma_m = 0.0;  // what the fitted figures make of it
    double bias_m = 0.0;          // root mean square of the fixed error; 0 where it is not separated
};

struct SensorFit {
    SensorNoise noise;  // the base with the fitted figures
    FittedFigure sigma_floor_m, sigma_per_square_metre, angle_factor, correlation_pixels, bias_sigma_m;
    FittedFigure row_correlation_pixels, column_correlation_pixels;  // correlation_pixels of each direction alone
    int frames = 0;                                                  // that were used
    bool separated = false;                                          // noise from fixed error
    double misfit = 0.0;  // root of chi^2 per degree of freedom of the cells; intervals are widened where above 1
    std::vector<NoiseCell> cells;
    std::vector<WallGroup> groups;
    std::vector<std::string> notes;  // what could not be determined, and what was left out
};

// `base` gives the other figures and sigma_least_at_m; `count_m` is the step of the depth's counts. Throws
// std::runtime_error with numbers and advice where the frames show no flat wall or have too few pixels, and
// std::invalid_argument where their sizes differ.
SensorFit fit_sensor(std::span<const WallFrame> frames, const SensorNoise& base, double count_m,
                     const SensorFitOptions& options = {});

}  // namespace nearpose::simulate
