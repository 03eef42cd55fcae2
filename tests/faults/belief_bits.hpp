// All numbers of a belief and of a result, to be compared bit by bit.
#pragma once

#include <vector>

#include "core/estimator.hpp"

namespace nearpose::test {

// A field that is added to the belief or to what it holds does not compile here until it is listed.
std::vector<double> bits_of(const Belief& belief);
// But for times.
std::vector<double> bits_of(const UpdateResult& result);

}  // namespace nearpose::test
