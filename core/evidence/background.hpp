// The null hypothesis: the image without the object. What surrounds parts is mostly made of a few large planes (tables,
// walls, floors), so a pose is shown by what planes do not explain: relief, and depth steps where the model has them.
// What merely is not contradicted, as a flat face on a wall, is no evidence of an object.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/evidence/likelihood.hpp"
#include "core/observation/sensor_model.hpp"

namespace nearpose {

struct BackgroundOptions {
    int max_planes = 3;
    double min_share = 0.04;  // of the pixels with depth: what a plane must explain to count
    // Share of what a plane explains that lies beyond the model's silhouette, or of the grid's border that it explains.
    // A plane with less of both ends where the model does: it is no background, but a face of the object.
    double min_share_beyond = 0.1;
    int max_pixels = 1500;        // that planes are fitted to; all are judged
    int patches_per_side = 6;     // planes are tried through small patches on a lattice of so many by so many
    double step_cost = 0.5;       // of a depth step between two pixels that nothing predicts, in outliers
    double occlusion_cost = 0.1;  // of a pixel that something hides, beside what the hiding surface costs, in outliers
};

// Throws std::invalid_argument naming field, value and bound.
void validate(const BackgroundOptions& options);

// A plane by its points X in camera coordinates: coefficients . X = 1 [1/m]. Planes through the camera have none.
using PlaneCoefficients = Eigen::Vector3f;

// The planes that explain most of the measured pixels and go on beyond the model, largest first. `view` tells where in
// the grid the model is. The same grid gives the same bits.
std::vector<PlaneCoefficients> fit_background(const View& view, const ObservedGrid& observed,
                                              const PixelCostOptions& pixel_cost, const BackgroundOptions& options);

// How a pose with its surroundings explains the image beyond the planes alone. In pixels that cost 1 (an outlier).
struct PositiveEvidence {
    double relief = 0.0;      // pixels that the model explains and planes do not
    double steps = 0.0;       // depth steps that the model predicts
    double occlusion = 0.0;   // cost of what would have to hide the model
    double free_space = 0.0;  // cost of what the sensor saw through
    double coplanar = 0.0;    // cost of model that ends where the measured surface goes on

    double total() const { return relief + steps - occlusion - free_space - coplanar; }
};

// Both hypotheses have the planes; the null hypothesis has them alone. A pixel costs the truncated square of its
// residual. Two pixels that different planes explain cost a step, unless the planes cross between them (a Potts model,
// Boykov, Veksler and Zabih 2001). Under the pose, steps within the model and at its outline are predicted and free.
// `view` must have been generated at `camera_from_object` with observed.camera.
PositiveEvidence positive_evidence(const View& view, const Pose& camera_from_object, const ObservedGrid& observed,
                                   const std::vector<PlaneCoefficients>& planes, const PixelCostOptions& pixel_cost,
                                   const BackgroundOptions& options);

// The evidence as log-odds that the object is there [nats]. Rays `stride` pixels of the image apart share the sensor's
// fine errors over its correlation length, so that (length / stride)^2 of them, at least 1, are one piece of evidence.
double log_odds_present(const PositiveEvidence& evidence, int stride, const PixelCostOptions& pixel_cost,
                        const SensorModel& sensor);

}  // namespace nearpose
