// An image that is the one before is no new observation.
#pragma once

#include "core/result.hpp"
#include "core/update/belief.hpp"
#include "core/update/frame.hpp"

namespace nearpose {

// The prediction, which stands in where nothing new was observed: neither confirmed nor contradicted.
UpdateResult predicted_alone(const Belief& predicted, const Frame& frame);

}  // namespace nearpose
