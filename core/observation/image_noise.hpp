// What an image tells of its sensor's noise. A plane's inverse depth is linear over the image, so its second
// differences are noise alone. Quantiles over many pixels are robust against edges and curved surfaces.
#pragma once

#include "core/base/camera.hpp"
#include "core/observation/organised_image.hpp"
#include "core/observation/sensor_model.hpp"

namespace nearpose {

struct NoiseOptions {
    int reach_pixels = 3;       // between the depths that are compared: direct neighbours share their noise
    double samples = 3000.0;    // about so many pixels are looked at
    int min_samples = 100;      // fewer do not tell
    double least_factor = 0.5;  // bounds of the factor
    double most_factor = 10.0;
    // A second difference of small reach is as large as one of great reach where the noise is independent, and smaller
    // where neighbours share it. Ratios from `independent_ratio` on, and up to `shared_ratio`, leave no doubt.
    int small_reach_pixels = 2;
    int great_reach_pixels = 8;
    double independent_ratio = 0.65;
    double shared_ratio = 0.5;
};

// Throws std::invalid_argument naming field, value and bound.
void validate(const NoiseOptions& options);

// What one image shows.
struct ImageNoise {
    double factor = 1.0;  // times the sensor model's noise
    double shared = 1.0;  // whether pixels some pixels apart share it, in 0..1; 1 where nothing tells
};

// How many times the sensor model's noise the candidates show: a second difference has the variance 6 sigma^2 / z^4. 1
// where too few tell.
double measured_noise_factor(const OrganisedImage& image, const PinholeCamera& camera,
                             const CandidateExtent& candidates, const SensorModel& sensor, const NoiseOptions& options);

// Whether pixels that are some pixels apart share their noise, as where a sensor gives one value for a window: 0 where
// it is independent, 1 where they share it. Measured over the whole image; 1 where too few pixels tell, since most
// sensors are so.
double measured_shared_noise(const OrganisedImage& image, const PinholeCamera& camera, const NoiseOptions& options);

}  // namespace nearpose
