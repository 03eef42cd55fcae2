// BOP's diameter of a model.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace nearpose::data_set {

// The largest distance of two of the points; 0 for fewer than two.
double diameter_of(const std::vector<Eigen::Vector3f>& points);

}  // namespace nearpose::data_set
