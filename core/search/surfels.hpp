// The measured surface on a coarse grid of the image, and what each place of it says about where a part is.
#pragma once

#include <vector>

#include "core/base/random.hpp"
#include "core/observation/observation.hpp"
#include "core/search/sampling.hpp"

namespace nearpose {

// The measured surface on a coarse grid of the image.
struct Surfel {
    Eigen::Vector3f point_in_camera = Eigen::Vector3f::Zero();  // z 0: not measured
    OrientedPoint surface{{0, 0, 0}, {0, 0, 0}};  // in camera coordinates; normal zero where none is known
    bool in_plane = false;                        // one of the largest in view
    // All in 0..1. A plane larger than any face of the model is none of its faces, and agreement there says little.
    double draw_weight = 0.0;           // how likely it is drawn for half of the starts; 0 where no normal is known
    double balanced_draw_weight = 1.0;  // how likely it is drawn for the others, and among the points that starts are
                                        // prune with, at any distance: a plane that fills the view gives few
    double weight = 1.0;                // and otherwise
};

struct SurfelGrid {
    int stride = 1, width = 0, height = 0;
    std::vector<Surfel> surfels;

    // The surfel that a pixel lies in; null at the image's last columns and rows, beyond the grid.
    const Surfel* at(const PinholeCamera& camera, int pixel) const {
        const int u = pixel % camera.width / stride, v = pixel / camera.width / stride;
        return u < width && v < height ? &surfels[static_cast<std::size_t>(v) * width + u] : nullptr;
    }
};

// `reach` is that of the normals in pixels, `tolerance_m` how far points of one plane may lie off it, `largest_face_m2`
// of the model (see largest_face).
SurfelGrid make_surfels(const Observation& observation, int reach, double tolerance_m, double largest_face_m2,
                        RandomStream random);

// Area of the largest flat face among a model's points: of the rectangle that has its points' moments [m^2].
double largest_face(const std::vector<OrientedPoint>& points, double tolerance_m);

}  // namespace nearpose
