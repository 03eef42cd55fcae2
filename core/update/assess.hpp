// What is said of the estimate: covariance, observability, evidence and verdict.
#pragma once

#include <optional>

#include "core/fit/joint_fit.hpp"
#include "core/result.hpp"
#include "core/update/belief.hpp"
#include "core/update/frame.hpp"

namespace nearpose {

// Writes into `result` what is known of the tracked pose: the pose, its cost, covariance, observability, the modes'
// covariances, pixels and verdict. Status and modes of the result are set before. `fit` is this observation's own, if
// one was made. Gives what the record of the lock takes from it.
Assessment assess(UpdateResult& result, const Belief& belief, const std::optional<JointFit>& fit, const Frame& frame,
                  Ledger& ledger);

}  // namespace nearpose
