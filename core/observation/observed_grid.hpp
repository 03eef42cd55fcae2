// A coarse grid of an observation's pixels: the rays on which poses are compared with it.
#pragma once

#include <vector>

#include "core/base/camera.hpp"
#include "core/observation/observation.hpp"

namespace nearpose {

// The measurements at the pixels of a grid, gathered once for all particles.
struct ObservedGrid {
    PixelGrid grid;
    PinholeCamera camera;    // camera_of(grid, observation.camera())
    bool segmented = false;  // as Observation::segmented
    int num_candidates = 0;
    std::vector<PixelState> states;  // row-major over the grid
    std::vector<float> depth_m;      // 0 where kNoDepth
    std::vector<float> sigma_m;      // of this image at that depth
    double mixes_steps = 0.0;        // how surely the sensor mixes the surfaces at a depth step (shared_noise), 0..1
    std::vector<char> at_step;       // 1 where the sensor mixes a depth step or hole within edge_pixels
    std::vector<float> weights;      // of the pixels' evidence for a pose, in 0..1; empty: 1 everywhere

    double weight(int index) const { return weights.empty() ? 1.0 : static_cast<double>(weights[index]); }
};

// Reads the observation at every pixel of `grid`.
ObservedGrid observe(const Observation& observation, const PixelGrid& grid);

}  // namespace nearpose
