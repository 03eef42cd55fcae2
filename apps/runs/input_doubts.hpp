// What looks wrong about a recording though it can be read: intrinsics of another image, an inverted mask, a wrong
// scale. All are doubts, not errors: each returns a sentence for the user, or nothing.
#pragma once

#include <string>

#include "core/base/camera.hpp"
#include "core/base/depth_image.hpp"
#include "core/view_generator.hpp"

namespace nearpose::program {

// Where the principal point is more than a tenth of the image from its middle, or the field of view is none of a depth
// camera's: what the likely cause is.
std::string camera_doubt(const PinholeCamera& camera);

// Where the mask holds the image's border, and what it leaves out lies nearer than what it covers.
std::string mask_doubt(const DepthImage& depth, const Mask& mask);

// Of a frame in which the part is likely whole. With a mask that ends within the image: where what it shows is much
// larger or smaller than the part. Without: where the part is much larger than what the image shows at its median
// depth.
std::string scale_doubt(const DepthImage& depth, const Mask* mask, const PinholeCamera& camera,
                        const ModelExtent& extent);

// Where depth changes at every second, third ... eighth column and row alone: it was measured at a fraction of the
// image's resolution, as sensors' decimation filters do, and enlarged.
std::string decimation_doubt(const DepthImage& depth);

}  // namespace nearpose::program
