// Where the model has depth steps. A sensor that gives one value for a window mixes both sides of them.
#pragma once

#include <vector>

#include "core/observation/observed_grid.hpp"
#include "core/view_generator.hpp"

namespace nearpose {

// Index in the view of the ray at each pixel of the grid; -1 where the view has none.
std::vector<int> rays_on_grid(const View& view, const PixelGrid& grid);

// Of each ray of the view, 1 where the model has a depth step or ends `reach` grid steps away in one of eight
// directions: where it departs from the ray's tangent plane by more than `step_sigmas` of the sensor there. 0 for a
// reach of 0.
std::vector<char> rays_at_steps(const View& view, const ObservedGrid& observed, int reach, double step_sigmas);

}  // namespace nearpose
