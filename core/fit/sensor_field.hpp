// The sensor's systematic errors as unknowns: a smooth field of depth errors over the image and an error of scale.
#pragma once

#include <Eigen/Core>
#include <array>

#include "core/base/camera.hpp"
#include "core/observation/sensor_model.hpp"

namespace nearpose {

// Depth measured - true = sum over nodes of weight * value [m] + scale * depth. The nodes stand on a square grid over
// the image; between four of them the field is interpolated, with weights whose squares sum to 1, so that it varies as
// much between nodes as on them.
struct SensorField {
    int nodes_u = 0, nodes_v = 0;
    double spacing_pixels = 1.0;

    int num_nodes() const { return nodes_u * nodes_v; }
    int num_unknowns() const { return num_nodes() + 1; }  // the nodes, row by row, then the scale

    // What the depth error at pixel (u, v) is linear in: indices of unknowns and their factors.
    struct Row {
        std::array<int, 5> unknowns;
        std::array<double, 5> factors;
    };
    Row row_at(double u, double v, double depth_m) const;
};

SensorField field_over(const PinholeCamera& camera, const SensorModel& sensor);

// Variances of the unknowns before anything was seen.
Eigen::VectorXd prior_variances(const SensorField& field, const SensorModel& sensor);

}  // namespace nearpose
