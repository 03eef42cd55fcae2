// The sensor's systematic errors as unknowns: a smooth field of depth errors over the image, and an error of scale.
#pragma once

#include <Eigen/Core>
#include <array>

#include "core/base/camera.hpp"
#include "core/observation/sensor_model.hpp"

namespace nearpose {

// measured depth - true depth = sum over nodes of weight * value [m] + scale * depth.
// The nodes stand on a square grid over the image. Between four of them the field is interpolated with weights whose
// squares sum to 1, so that it has the same variance between nodes as on them.
struct SensorField {
    int nodes_u = 0, nodes_v = 0;
    double spacing_pixels = 1.0;

    int num_nodes() const { return nodes_u * nodes_v; }
    int num_unknowns() const { return num_nodes() + 1; }  // the nodes, row by row, then the scale

    // The depth error at pixel (u, v) is a linear function of five unknowns: their indices and factors.
    struct Row {
        std::array<int, 5> unknowns;
        std::array<double, 5> factors;
    };
    Row row_at(double u, double v, double depth_m) const;
};

struct FieldOptions {
    // Spacing of the nodes, in lengths over which pixels share an error. Coarser nodes cannot tell the field from the
    // pose; finer ones cost time.
    double spacing_lengths = 1.5;
    // At most so many spacings along the image's longer side. A finer field cannot be told from noise, nor afforded.
    double max_spacings = 16.0;
};

SensorField field_over(const PinholeCamera& camera, const SensorModel& sensor, const FieldOptions& options = {});

// Variances of the unknowns before anything was seen: nodes [m^2], then the scale.
Eigen::VectorXd prior_variances(const SensorField& field, const SensorModel& sensor);

}  // namespace nearpose
