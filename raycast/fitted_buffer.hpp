// Views of surface samples on a depth buffer of its own, whose cells fit the samples rather than the image.
//
// The samples are so dense that one stands for `area_per_sample` of the surface. `coverage` says how many samples on
// average lie on a cell or splat where the surface faces the camera. Of samples that fall at random exp(-coverage) of
// a surface stays open, and what lies behind shows there.
#pragma once

#include <Eigen/Core>

#include "core/base/camera.hpp"
#include "core/base/pose.hpp"
#include "core/view_generator.hpp"
#include "raycast/surface_samples.hpp"

namespace nearpose {

// Width and height [pixels] of the cell that sees `area_m2` of a surface which faces the camera at `depth_m`:
// f * sqrt(area) / depth. Never less than a pixel, so that a view has room for all that is kept.
Eigen::Array2d cell_size_px(double area_m2, double depth_m, const PinholeCamera& camera);

// The camera whose pixels are cells of that size; its image covers that of `camera`. No cell is larger than the image.
PinholeCamera camera_of_cells(const Eigen::Array2d& cell_px, const PinholeCamera& camera);

// Cells of cell_size_px(cell_area, depth of the nearest sample in the image): the nearest sample of each is kept.
// Surface farther away or seen at a slant has more samples in a cell, never fewer. All in this file: of samples that
// share a pixel of `camera` the nearest is kept; throws std::invalid_argument if the pose or the camera is not valid.
View nearest_of_cells(const SurfaceSamples& samples, double cell_area_m2, const Pose& camera_from_object,
                      const PinholeCamera& camera);

// Every sample is drawn as a disc of `splat_area` in its tangent plane, and those that lie behind a disc are dropped.
// A disc hides only what is more than a fifth of its radius behind it, so that a curved surface does not hide itself.
// One that is tilted by more than about 40 degrees still hides some of its own samples, of which it has more a pixel.
View points_before_splats(const SurfaceSamples& samples, double splat_area_m2, const Pose& camera_from_object,
                          const PinholeCamera& camera);

}  // namespace nearpose
