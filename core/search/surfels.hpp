// The measured surface as surfels on a coarse grid of the image, and what each says about where a part is.
#pragma once

#include <vector>

#include "core/base/random.hpp"
#include "core/observation/observation.hpp"
#include "core/search/oriented_point.hpp"
#include "core/search/search_options.hpp"

namespace nearpose {

// A small piece of the measured surface.
struct Surfel {
    Eigen::Vector3f point_in_camera = Eigen::Vector3f::Zero();  // z 0: not measured
    OrientedPoint surface{{0, 0, 0}, {0, 0, 0}};  // in camera coordinates; the normal is zero where none is known
    bool in_plane = false;                        // in one of the largest of the view
    // Three weights in 0..1. Less than 1 have large planes: one larger than any face of the model is none of its faces.
    double draw_weight = 0.0;           // of being drawn for a pair; 0 where no normal is known
    double balanced_draw_weight = 1.0;  // the same where a plane that fills the view counts as a small part of it
    double evidence_weight = 1.0;       // what agreement with it counts
};

struct SurfelGrid {
    int stride = 1, width = 0, height = 0;  // stride in pixels
    std::vector<Surfel> surfels;            // row by row

    // The surfel that a pixel lies in; null in the image's last columns and rows, beyond the grid.
    const Surfel* at(const PinholeCamera& camera, int pixel) const {
        const int u = pixel % camera.width / stride, v = pixel / camera.width / stride;
        return u < width && v < height ? &surfels[static_cast<std::size_t>(v) * width + u] : nullptr;
    }
};

// `reach_pixels` is that of the normals' window. Points of one plane lie off it by less than `tolerance_m`.
// `largest_face_m2` is the model's, see largest_face.
SurfelGrid make_surfels(const Observation& observation, int reach_pixels, double tolerance_m, double largest_face_m2,
                        RandomStream random, const SurfelOptions& options);

// Area of the largest flat face among a model's points: of the rectangle with the same second moments [m^2].
double largest_face(const std::vector<OrientedPoint>& surface, double tolerance_m, const LargestFaceOptions& options);

// About `count` measured oriented points (in camera coordinates), drawn systematically by their balanced draw weight: a
// plane that fills the view gives few. Any number of the first ones are spread over the image as all are.
std::vector<OrientedPoint> systematic_sample(const SurfelGrid& grid, std::size_t count);

}  // namespace nearpose
