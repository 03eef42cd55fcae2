// Disparities of two rectified grey images by semi-global matching (Hirschmueller 2008), as OpenCV has it.
#pragma once

#include <cstdint>
#include <vector>

#include "apps/depth_sensor/stereo_rig.hpp"

namespace nearpose::simulate {

struct GreyImage {
    int width = 0, height = 0;        // [pixels]
    std::vector<std::uint8_t> value;  // row-major
};

// Whether the program was built with the matcher.
bool stereo_is_built();

// Throws std::runtime_error that says what to install where the program was built without the matcher.
void require_stereo();

// Of each pixel of the left image: how far to the left its surface appears in the right one [pixels]; negative where
// nothing matches, or where it would lie beyond the right image. That may be wider: its last columns are the left
// image's. Disparities in 0..max_disparity are tried. Serial; the same images give the same bits. Throws as
// require_stereo does, and std::invalid_argument where the right image is narrower, of another height, or wider by more
// than max_disparity.
std::vector<float> match(const GreyImage& left, const GreyImage& right, int max_disparity, const StereoRig& rig);

}  // namespace nearpose::simulate
