#include "apps/report/quantised.hpp"

#include <cmath>

namespace nearpose::report {

QuantisedPoints quantise(const std::vector<Eigen::Vector3f>& points_m) {
    QuantisedPoints result;
    if (points_m.empty()) return result;
    Eigen::Vector3d low = points_m.front().cast<double>(), high = low;
    for (const Eigen::Vector3f& point : points_m) {
        low = low.cwiseMin(point.cast<double>());
        high = high.cwiseMax(point.cast<double>());
    }
    result.offset_m = 0.5 * (low + high);
    // All points in one place: any step does.
    result.step_m = std::max((high - low).maxCoeff() / 65534.0, 1e-12);
    result.values.reserve(3 * points_m.size());
    for (const Eigen::Vector3f& point : points_m) {
        for (int axis = 0; axis < 3; ++axis) {
            const double steps = (static_cast<double>(point[axis]) - result.offset_m[axis]) / result.step_m;
            result.values.push_back(static_cast<std::int16_t>(std::lround(steps)));
        }
    }
    return result;
}

Eigen::Vector3d point_of(const QuantisedPoints& points, std::size_t index) {
    const std::int16_t* values = &points.values[3 * index];
    return points.offset_m + points.step_m * Eigen::Vector3d(values[0], values[1], values[2]);
}

}  // namespace nearpose::report
