// What is said of the estimate: covariance, observability, evidence and verdict.
#pragma once

#include <optional>

#include "core/result.hpp"
#include "core/update/belief.hpp"
#include "core/update/frame.hpp"

namespace nearpose {

// Describes the tracked pose in `result`, whose status and modes are set: pose, cost, covariance, observability, modes'
// covariances, pixels and verdict. `fit_covariance`: of the observation's own fit about the model's centre, if one was
// made. Gives what the record of the lock takes from it.
Assessment assess(UpdateResult& result, const Belief& belief, const std::optional<Matrix6d>& fit_covariance,
                  const Frame& frame, Ledger& ledger);

}  // namespace nearpose
