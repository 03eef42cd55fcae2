#include "core/observation/observed_grid.hpp"

namespace nearpose {

ObservedGrid observe(const Observation& observation, const PixelGrid& grid) {
    ObservedGrid observed;
    observed.grid = grid;
    observed.camera = camera_of(grid, observation.camera());
    observed.segmented = observation.segmented();
    observed.states.reserve(grid.size());
    observed.depth_m.reserve(grid.size());
    observed.sigma_m.reserve(grid.size());
    for (int index = 0; index < grid.size(); ++index) {
        const int pixel = grid.image_v(index) * observation.camera().width + grid.image_u(index);
        const float depth_m = observation.depth_m()[pixel];
        observed.states.push_back(observation.states()[pixel]);
        observed.depth_m.push_back(depth_m);
        observed.sigma_m.push_back(static_cast<float>(observation.sigma_m(depth_m)));
        observed.num_candidates += observation.states()[pixel] == PixelState::kCandidate;
    }
    return observed;
}

}  // namespace nearpose
