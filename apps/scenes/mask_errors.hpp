// Masks as a segmentation that is not perfect would draw them.
#pragma once

#include "core/base/depth_image.hpp"
#include "raycast/depth_renderer.hpp"

namespace nearpose::simulate {

struct MaskErrors {
    int grow_pixels = 0;   // dilated by so many pixels; negative: eroded
    int bleed_pixels = 0;  // spills so far over onto surfaces that touch the part (its table), not over depth edges
};

// Throws std::invalid_argument naming field, value and bound.
void validate(const MaskErrors& errors);

// `exact` is the mask of the visible pixels, `image` what was rendered with it.
Mask with_errors(const Mask& exact, const RenderedImage& image, const MaskErrors& errors);

}  // namespace nearpose::simulate
