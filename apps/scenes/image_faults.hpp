// What faults do to one image: its depth, and the mask that a segmentation draws in it.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "apps/scenes/fault.hpp"
#include "core/base/depth_image.hpp"
#include "raycast/depth_renderer.hpp"

namespace nearpose::simulate {

// What was before the camera, and whose chance it is.
struct ImageContext {
    const RenderedImage& exact;
    const PinholeCamera& camera;
    double min_range_m = 0.0, max_range_m = 0.0;  // of the sensor
    std::uint64_t seed = 1;
    int frame = 0;
    int fault = 0;  // place among the recording's faults: two of a kind draw differently
};

// Faults of other kinds change nothing, and nor does kTemporalFilter, which needs the image before.
void apply_fault(const Fault& fault, const ImageContext& context, DepthImage& depth, Mask& mask);

// As librealsense documents its temporal filter: where both images have a depth and differ by less than 20 mm, alpha
// times the new one and the rest of the one before; a hole takes the depth before; all else is new.
DepthImage temporally_filtered(const DepthImage& before, DepthImage now, double alpha);

// The last depth that left each fault that remembers one, by the fault's place in the list.
using FaultMemory = std::map<std::size_t, DepthImage>;

// All that are in the frame, in their order. `context.fault` is of no account. `memory` must be that after the image
// before; it becomes that after this one.
void apply_faults(const std::vector<Fault>& faults, ImageContext context, FaultMemory& memory, DepthImage& depth,
                  Mask& mask);

}  // namespace nearpose::simulate
