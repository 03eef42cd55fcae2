// Points in 16 bits a coordinate.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace nearpose::report {

// point = offset_m + step_m * values; the error of a coordinate is at most half a step, which is a 65535th of the
// largest side of the points' box.
struct QuantisedPoints {
    Eigen::Vector3d offset_m = Eigen::Vector3d::Zero();
    double step_m = 0.0;
    std::vector<std::int16_t> values;  // x y z x y z ...
};

QuantisedPoints quantise(const std::vector<Eigen::Vector3f>& points_m);
Eigen::Vector3d point_of(const QuantisedPoints& points, std::size_t index);

}  // namespace nearpose::report
