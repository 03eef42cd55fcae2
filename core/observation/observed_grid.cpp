#include "core/observation/observed_grid.hpp"

#include <cmath>

namespace nearpose {

namespace {

// Whether a surface bends or ends within `reach` pixels of a pixel with depth. The inverse depth of a plane is linear
// over the image, so second differences leave slopes out.
bool is_at_step(const Observation& observation, int pixel, int reach) {
    if (reach == 0) return false;
    const int width = observation.camera().width, height = observation.camera().height;
    const int u = pixel % width, v = pixel / width;
    if (u < reach || v < reach || u + reach >= width || v + reach >= height) return false;
    const std::vector<float>& depth_m = observation.depth_m();
    const double z_m = depth_m[pixel];
    const double step_m = 2.0 * observation.sensor().edge_step_sigmas * observation.sigma_m(z_m);
    for (const int offset : {reach, reach * width, reach * (width + 1), reach * (width - 1)}) {
        const double before_m = depth_m[pixel - offset], after_m = depth_m[pixel + offset];
        if (before_m == 0.0 || after_m == 0.0) return true;
        if (std::abs(z_m * (z_m / before_m + z_m / after_m - 2.0)) > step_m) return true;
    }
    return false;
}

}  // namespace

ObservedGrid observe(const Observation& observation, const PixelGrid& grid) {
    ObservedGrid observed;
    observed.grid = grid;
    observed.camera = camera_of(grid, observation.camera());
    observed.segmented = observation.segmented();
    observed.mixes_steps = observation.shared_noise();
    const int reach = static_cast<int>(observation.sensor().edge_pixels);
    observed.states.reserve(grid.size());
    observed.depth_m.reserve(grid.size());
    observed.sigma_m.reserve(grid.size());
    observed.at_step.reserve(grid.size());
    for (int index = 0; index < grid.size(); ++index) {
        const int pixel = grid.image_v(index) * observation.camera().width + grid.image_u(index);
        const float depth_m = observation.depth_m()[pixel];
        observed.states.push_back(observation.states()[pixel]);
        observed.depth_m.push_back(depth_m);
        observed.sigma_m.push_back(static_cast<float>(observation.sigma_m(depth_m)));
        observed.at_step.push_back(observed.mixes_steps > 0.0 && depth_m > 0.0F &&
                                   is_at_step(observation, pixel, reach));
        observed.num_candidates += observation.states()[pixel] == PixelState::kCandidate;
    }
    return observed;
}

}  // namespace nearpose
