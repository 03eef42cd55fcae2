// The observation model: how well a pose explains an observation. Costs are negative log-likelihoods up to scale and
// offset: smaller is better.
#pragma once

#include "core/correspondences.hpp"
#include "core/observation/observed_grid.hpp"
#include "core/view_generator.hpp"

namespace nearpose {

// The paper's cost: epsilon = (m / n) * MSE over n matched pairs of a view of m points [m^2]. Without any pair it is
// (m + 1) * max_distance_m^2, worse than any value with pairs.
double overlap_scaled_mse(const Correspondences& pairs, const Pose& camera_from_object, std::size_t num_view_points,
                          double max_distance_m);

// The paper does not say how epsilon becomes a likelihood for the effective sample size. A pair's squared residual is
// Gaussian with the sensor's variance where the pair is right, and that of a chance match within the gate, 3/5 gate^2
// (uniform in a ball), where it is not; the MSE mixes both, so the likelihood is exp(-epsilon / (2 (sigma^2 + 3/5
// gate^2))). Returns the negative log-likelihood.
double negative_log_likelihood(double overlap_scaled_mse_m2, double sensor_sigma_m, double max_distance_m);

// Which likelihood weighs the particles: the paper's mean squared error of pairs, or a cost of every ray.
enum class Cost { kOverlapMse, kPixels };

struct PixelCostOptions {
    double truncation_sigmas = 3.0;  // a residual beyond it is no better than any other
    double extra_sigma_m = 0.0;      // added in quadrature to the sensor's noise: how far off a pose may still be [m]
    double free_space_cost = 4.0;  // where nothing is segmented: of model that lies deep before what is measured, which
                                   // no fault of a CAD and no mixed pixel explains; 1: depth makes no difference
    double free_space_depth_m =
        0.0;  // 0: none is deep; else model farther before it costs more than 1, from twice that on free_space_cost
    double occluded_cost = 0.3;     // of model behind something measured: it may be hidden
    double unexplained_cost = 0.5;  // of a measured pixel that no model covers, where nothing is segmented
    bool with_outline = false;      // whether rays at the model's outline are looked at
    double outline_cost = 3.0;  // where nothing is segmented: of one beyond which the measured surface just goes on,
                                // as if the object had no end there
    double outline_sigma_m = 0.001;  // how far the model's surface may be off there, beside the sensor's noise [m]
    double independent_rays = 40.0;  // neighbouring rays share the sensor's errors: so many count as independent
};

// Verdicts of the pixels of one view.
struct PixelCost {
    double cost = 1.0;       // mean over the judged pixels, in 0..1; more where outline_cost or free_space_cost is
    double gain = 0.0;       // pixels' cost without the object less that with it, where nothing is segmented
    int judged = 0;          // pixels with model or candidate, and depth
    int model_rays = 0;      // of them those with model
    int agreeing = 0;        // model and depth agree within the truncation
    bool segmented = false;  // as the observation
    int missing_model = 0;   // candidate pixels without model
    int free_space_violations = 0;  // model before the measured surface: the sensor looked through it
    int occluded = 0;               // model behind the measured surface
    int off_mask = 0;               // on the measured surface, but of the background, says the mask
    int contradicted = 0;           // in front, or behind what the mask says is the object
    int outline = 0;                // agreeing rays at the model's outline where something is measured beyond
    int coplanar = 0;               // of them those where the measured surface goes on beyond

    // Share of the model's rays that agree with the measured depth, in 0..1.
    double support() const { return model_rays > 0 ? static_cast<double>(agreeing) / model_rays : 0.0; }
    // Share of the rays that say anything about the object's surface which agree with it, in 0..1: hidden ones do not.
    double agreement() const { return agreeing > 0 ? static_cast<double>(agreeing) / (agreeing + contradicted) : 0.0; }
    // Of the mask's pixels and the model's together the share in which both agree, in 0..1; 1 without a mask.
    double overlap() const {
        if (!segmented) return 1.0;
        return agreeing > 0 ? static_cast<double>(agreeing) / (agreeing + missing_model + off_mask) : 0.0;
    }
    double coplanar_share() const { return outline > 0 ? static_cast<double>(coplanar) / outline : 0.0; }
};

// The default method's cost: each ray of the grid compares the model's depth z_m with the measured z_o, r = (z_o - z_m)
// cos(normal, ray) / sigma. Where the observation is segmented:
//   candidate pixel: min(r^2 / truncation^2, 1); no model there: 1
//   background pixel: model in front of it: 1; behind it or on it: occluded_cost
// and where it is not, model behind something is no better than no model, which costs `unexplained_cost`, and model in
// front of something (by more than the truncation) costs 1 up to free_space_depth_m and then more, up to
// free_space_cost at twice that depth: a wrong pose among other things may agree with much, but the sensor looks
// through it by far. Pixels without depth say nothing, and what a pixel says for the model counts with its weight. A
// face of the model laid into a larger flat one agrees with it everywhere but is no object: a ray of it at the outline
// counts as `outline_cost`, not as agreeing, and of what the rays within explain the square of coplanar_share() is
// taken off. `view` must have been generated at `camera_from_object` with observed.camera; of a sample counts where its
// tangent plane meets its pixel's ray.
PixelCost pixel_cost(const View& view, const Pose& camera_from_object, const ObservedGrid& observed,
                     const PixelCostOptions& options);

// How much better the pixels speak for one pose than for another is the difference of this [nats]. Rays share errors of
// sensor and CAD with their neighbours: `rays_per_evidence` of them count as one. -truncation^2 / 2 * cost * judged /
// rays_per_evidence.
double log_evidence(const PixelCost& cost, const PixelCostOptions& options, double rays_per_evidence);

// The same against no object at all: every judged pixel costs 1.
double log_evidence_over_nothing(const PixelCost& cost, const PixelCostOptions& options, double rays_per_evidence);

// Of a pose with that cost: independent_rays * truncation^2 / 2 * cost.
double negative_log_likelihood(const PixelCost& cost, const PixelCostOptions& options);

}  // namespace nearpose
