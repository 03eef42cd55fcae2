// A camera that comes closer to a part of known closed form: what the tests of the estimator share.
#pragma once

#include <memory>

#include "core/estimator.hpp"
#include "tests/core/analytic_part.hpp"

namespace nearpose::test {

inline const auto kPart = std::make_shared<BoxViewGenerator>(asymmetric_part());
inline const auto kSolver = std::make_shared<GaussNewtonSolver>();
inline const PinholeCamera kCamera = small_camera();

// The camera comes closer and turns a little.
Pose truth_at(int frame);
Pose motion_to(int frame);

Observation observe_at(int frame);
Observation observe_without_mask(int frame);
Observation observe_nothing();

EstimatorOptions small_options(Method method, int threads);

double error_m(const UpdateResult& result, int frame);

}  // namespace nearpose::test
