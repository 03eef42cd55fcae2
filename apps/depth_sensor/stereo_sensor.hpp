// Depth as an active stereo camera makes it: two infrared images of a scene with projected dots, matched. Or as a
// structured-light camera does: one image, matched with the known pattern of dots. What real sensors do follows from
// it: one value for a window, edges that grow, shadows, holes, errors that neighbours share.
#pragma once

#include <cstdint>

#include "apps/depth_sensor/dot_projector.hpp"
#include "apps/depth_sensor/stereo_matcher.hpp"
#include "apps/depth_sensor/stereo_rig.hpp"
#include "core/base/camera.hpp"
#include "core/base/depth_image.hpp"

namespace nearpose::simulate {

struct InfraredPair {
    // Of structured light the right one is the pattern without noise, as a camera at the projector would see it; it has
    // as many columns more on its left as disparities are tried.
    GreyImage left, right;
};

// What both cameras see, exposed so that the left image is well lit. Objects of the images that `render` makes are of
// the material where their index is below `num_parts`; all else is of grey paint. The seed draws the dots, seed and
// frame the noise. Serial; the same arguments give the same bits.
InfraredPair infrared_images(const RenderFrom& render, const PinholeCamera& camera, const StereoRig& rig,
                             const Material& material, int num_parts, std::uint64_t seed, std::uint64_t frame);

// Depth in the left camera [m], 0 where nothing matches or the range ends. Throws std::runtime_error where the program
// was built without the matcher.
DepthImage depth_of(const InfraredPair& images, const PinholeCamera& camera, const StereoRig& rig);

}  // namespace nearpose::simulate
