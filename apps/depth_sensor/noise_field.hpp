// Gaussian noise that neighbouring pixels share. Every value has mean 0 and standard deviation 1, also at the borders.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/base/random.hpp"

namespace nearpose::simulate {

// Row-major; the four channels are independent of each other. White noise smoothed with a Gaussian of
// `correlation_pixels` (0: white).
std::vector<Eigen::Array4f> correlated_noise(int width, int height, double correlation_pixels, std::uint64_t seed,
                                             std::uint64_t frame, RandomPurpose purpose);

// Row-major. Nodes every `length_pixels`, between them a bicubic B-spline.
std::vector<float> smooth_field(int width, int height, double length_pixels, std::uint64_t seed, std::uint64_t frame,
                                RandomPurpose purpose);

}  // namespace nearpose::simulate
