// Degrees are for people and files; inside, angles are in radians.
#pragma once

#include <numbers>

namespace nearpose {

inline constexpr double kDegrees = 180.0 / std::numbers::pi;  // of a radian

}  // namespace nearpose
