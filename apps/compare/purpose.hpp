// What comparisons draw random numbers for: addresses of their streams beside the simulation's.
#pragma once

#include "core/random.hpp"

namespace nearpose::compare {

inline constexpr auto kTimedViewDraw = static_cast<RandomPurpose>(200);  // poses around the true one

}  // namespace nearpose::compare
