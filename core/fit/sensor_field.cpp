#include "core/fit/sensor_field.hpp"

#include <algorithm>
#include <cmath>

namespace nearpose {

SensorField::Row SensorField::row_at(double u, double v, double depth_m) const {
    const int column = std::clamp(static_cast<int>(u / spacing_pixels), 0, nodes_u - 2);
    const int line = std::clamp(static_cast<int>(v / spacing_pixels), 0, nodes_v - 2);
    const double right = u / spacing_pixels - column, below = v / spacing_pixels - line;
    const double left = 1.0 - right, above = 1.0 - below;
    const double norm = std::sqrt((left * left + right * right) * (above * above + below * below));
    const int node = line * nodes_u + column;
    return {{node, node + 1, node + nodes_u, node + nodes_u + 1, num_nodes()},
            {left * above / norm, right * above / norm, left * below / norm, right * below / norm, depth_m}};
}

SensorField field_over(const PinholeCamera& camera, const SensorModel& sensor, const FieldOptions& options) {
    const double finest = std::max(camera.width, camera.height) / options.max_spacings;
    SensorField field;
    field.spacing_pixels = std::max(options.spacing_lengths * sensor.systematic_length_pixels, finest);
    field.nodes_u = static_cast<int>((camera.width - 1) / field.spacing_pixels) + 2;
    field.nodes_v = static_cast<int>((camera.height - 1) / field.spacing_pixels) + 2;
    return field;
}

Eigen::VectorXd prior_variances(const SensorField& field, const SensorModel& sensor) {
    // A variance of 0 cannot be inverted: an error that the sensor does not have keeps one that is negligible.
    constexpr double kLeastVariance = 1e-14;
    Eigen::VectorXd variances = Eigen::VectorXd::Constant(
        field.num_unknowns(), std::max(kLeastVariance, sensor.systematic_sigma_m * sensor.systematic_sigma_m));
    variances[field.num_nodes()] = std::max(kLeastVariance, sensor.depth_scale_sigma * sensor.depth_scale_sigma);
    return variances;
}

}  // namespace nearpose
