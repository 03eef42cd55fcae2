#include "core/observation/sensor_model.hpp"

#include "core/base/check.hpp"

namespace nearpose {

void validate(const SensorModel& sensor) {
    check_option("sensor.sigma_floor_m", sensor.sigma_floor_m, 1e-9, 1.0);
    check_option("sensor.sigma_per_square_metre", sensor.sigma_per_square_metre, 0.0, 1.0);
    check_option("sensor.systematic_sigma_m", sensor.systematic_sigma_m, 0.0, 1.0);
    check_option("sensor.systematic_length_pixels", sensor.systematic_length_pixels, 1.0, 1e4);
    check_option("sensor.lateral_sigma_pixels", sensor.lateral_sigma_pixels, 0.0, 100.0);
    check_option("sensor.systematic_fine_sigma_m", sensor.systematic_fine_sigma_m, 0.0, 1.0);
    check_option("sensor.systematic_fitted", sensor.systematic_fitted, 0.0, 1.0);
    check_option("sensor.scale_fitted", sensor.scale_fitted, 0.0, 1.0);
    check_option("sensor.depth_scale_sigma", sensor.depth_scale_sigma, 0.0, 1.0);
    check_option("sensor.focal_length_sigma", sensor.focal_length_sigma, 0.0, 1.0);
    check_option("sensor.image_shift_sigma_pixels", sensor.image_shift_sigma_pixels, 0.0, 1e3);
    check_option("sensor.edge_pixels", sensor.edge_pixels, 0.0, 1e3);
    check_option("sensor.edge_sigma_factor", sensor.edge_sigma_factor, 1.0, 1e3);
    check_option("sensor.edge_step_sigmas", sensor.edge_step_sigmas, 0.0, 1e3);
    check_option("sensor.min_range_m", sensor.min_range_m, 0.0, 1e3);
    check_option("sensor.max_range_m", sensor.max_range_m, sensor.min_range_m, 1e3);
}

}  // namespace nearpose
