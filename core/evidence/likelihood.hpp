// The observation model: how well a pose explains an observation. Costs are negative log-likelihoods up to scale and
// offset, so smaller is better.
#pragma once

#include "core/correspondences.hpp"
#include "core/observation/observed_grid.hpp"
#include "core/view_generator.hpp"

namespace nearpose {

// The paper's cost: epsilon = (m / n) * MSE over n matched pairs of a view of m points [m^2]. Without any pair it is
// (m + 1) * max_distance_m^2, worse than any value with pairs.
double overlap_scaled_mse(const Correspondences& pairs, const Pose& camera_from_object, std::size_t num_view_points,
                          double max_distance_m);

// The negative log-likelihood of a pose with that cost. The paper does not say how epsilon becomes a likelihood, which
// the effective sample size needs. A pair's squared residual has the sensor's variance where the pair is right. A
// chance match is uniform in a ball of the gate's radius, with mean square 3/5 gate^2. The mean squared error mixes
// both, so the likelihood is exp(-epsilon / (2 (sigma^2 + 3/5 gate^2))).
double negative_log_likelihood(double overlap_scaled_mse_m2, double sensor_sigma_m, double max_distance_m);

// Which likelihood weighs the particles: the paper's mean squared error of pairs, or a cost of every ray.
enum class Cost { kOverlapMse, kPixels };

// The costs are per ray. 1 is that of a residual at the truncation, which is the cost of an outlier.
struct PixelCostOptions {
    double truncation_sigmas = 3.0;  // residuals beyond it are outliers
    // Added in quadrature to the sensor's noise: how far off the pose may still be. Set by the estimator, as are
    // free_space_depth_m, with_outline and outline_sigma_m: they follow from the part's size and the stage.
    double extra_sigma_m = 0.0;
    // Where nothing is segmented, model before the measured surface violates free space: the sensor saw through it. It
    // costs 1 up to `free_space_depth_m` [m] before the surface, and `free_space_cost` from twice that depth on. No
    // error of the CAD and no mixed pixel explains so much. Depth 0: it costs 1 however deep it lies.
    double free_space_cost = 4.0;
    double free_space_depth_m = 0.0;
    double occluded_cost = 0.3;     // segmented: of model behind what is measured, which may be occluded
    double unexplained_cost = 0.5;  // not segmented: of a measured pixel that no model explains
    // Whether rays at the model's outline are tested for a measured surface that goes on in the model's tangent plane.
    // Where it does, the model is coplanar with its surroundings, and nothing shows that a part ends there.
    bool with_outline = false;
    double outline_cost = 3.0;         // not segmented: of such a ray
    double outline_sigma_m = 0.001;    // how far the model's surface may be off there, beside the sensor's noise
    double outline_gate_sigmas = 3.0;  // a point nearer to the tangent plane lies in it
    int outline_steps = 2;  // grid steps to the point that is tested: the pixel beside an edge is often a mixed one
    // A contradiction is deep from free_space_depth_m on, and from so many sigmas: no noise explains it.
    double deep_sigmas = 8.0;
    double independent_rays = 40.0;  // neighbouring rays share errors of the sensor: so many count as independent
};

// What the pixels of one view say about a pose.
struct PixelCost {
    double cost = 1.0;  // mean over the judged pixels, in 0..1; more where outline_cost or free_space_cost is more
    // By how much the model's rays cost less than the same pixels without an object, where nothing is segmented. In
    // pixels that cost 1.
    double gain = 0.0;
    int judged = 0;                 // pixels with depth that are covered by the model or are candidates
    int model_rays = 0;             // of them those with model
    int agreeing = 0;               // inliers: model and depth agree within the truncation
    bool segmented = false;         // as the observation
    int missing_model = 0;          // candidate pixels without model
    int free_space_violations = 0;  // model before the measured surface: the sensor saw through it
    int occluded = 0;               // model behind the measured surface
    int off_mask = 0;               // model on the measured surface, where the mask says that it is background
    int contradicted = 0;           // free-space violations, and model behind what the mask says is the object
    // Rays at depth steps that the sensor mixes, of those that agree and of those that contradict. Each counts as much
    // as it is sure that the sensor mixes (ObservedGrid::mixes_steps), and never quite 1: where there are steps
    // everywhere, they alone must tell.
    double mixed_agreeing = 0.0;
    double mixed_contradicted = 0.0;
    double deep = 0.0;  // what contradictions deep in free space count beyond 1
    int outline = 0;    // agreeing rays at the model's outline where something is measured beyond
    int coplanar = 0;   // of them those where the measured surface goes on in the model's tangent plane

    // Share of the model's rays that agree with the measured depth, in 0..1.
    double support() const { return model_rays > 0 ? static_cast<double>(agreeing) / model_rays : 0.0; }
    // Inlier ratio: share of the rays that agree among those that agree or contradict, in 0..1. Occluded rays do
    // neither.
    double inlier_ratio() const {
        return agreeing > 0 ? static_cast<double>(agreeing) / (agreeing + contradicted) : 0.0;
    }
    // The same for a verdict: rays at depth steps that the sensor mixes hardly count, and contradictions deep in free
    // space count twice.
    double agreement() const {
        const double agree = agreeing - mixed_agreeing;
        const double contradict = contradicted - mixed_contradicted + deep;
        return agree > 0.0 ? agree / (agree + contradict) : 0.0;
    }
    // Intersection over union of the mask and the model's rays on the measured surface, in 0..1. 1 without a mask.
    double overlap() const {
        if (!segmented) return 1.0;
        return agreeing > 0 ? static_cast<double>(agreeing) / (agreeing + missing_model + off_mask) : 0.0;
    }
    // Share of the outline that is coplanar with its surroundings, in 0..1.
    double coplanar_share() const { return outline > 0 ? static_cast<double>(coplanar) / outline : 0.0; }
};

// The default method's cost. Each ray of the grid compares the model's depth z_m with the measured depth z_o along the
// model's normal: r = (z_o - z_m) cos(normal, ray) / sigma. The cost is a quadratic that is truncated at
// t = truncation_sigmas (MSAC, Torr and Zisserman 2000), by cases as in a beam model (Thrun, Burgard and Fox
// 2005, 6.3). Pixels without depth are not judged, since sensors lose pixels on the object too.
//
//   segmented                          candidate pixel      background pixel
//     model agrees (|r| <= t)          r^2 / t^2            occluded_cost
//     model in front (r > t)           1                    1
//     model behind (r < -t)            1                    occluded_cost
//     no model                         1                    not judged
//   not segmented: all pixels are candidates
//     model agrees                     weight r^2 / t^2
//     model in front                   1, up to free_space_cost where it lies deep in free space
//     model behind, or no model        weight unexplained_cost
//
// The weight is the grid's (ObservedGrid::weights), 1 where it has none. A pose among other things may agree with much
// of the image, but the sensor sees through the rest of the model: hence the cost of free space.
// A face of the model that lies in a larger plane agrees with it everywhere, although no object is there. With
// `with_outline` and without a segmentation, a coplanar ray at the outline costs `outline_cost` and does not agree. The
// square of coplanar_share() is the share that the other rays lose of what they explain.
// `view` must have been generated at `camera_from_object` with observed.camera. A view of samples is compared where the
// tangent plane of a sample meets the ray of its pixel.
PixelCost pixel_cost(const View& view, const Pose& camera_from_object, const ObservedGrid& observed,
                     const PixelCostOptions& options);

// Log-likelihood of the image under a pose, up to an offset [nats]: differences between poses are log-odds. Rays share
// errors of sensor and CAD with their neighbours, so `rays_per_evidence` of them count as one:
//   -truncation^2 / 2 * cost * judged / rays_per_evidence.
double log_evidence(const PixelCost& cost, const PixelCostOptions& options, double rays_per_evidence);

// Log-odds of the pose against no object at all, where every judged pixel costs 1 [nats].
double log_evidence_over_nothing(const PixelCost& cost, const PixelCostOptions& options, double rays_per_evidence);

// Negative log-likelihood that weighs a particle with that cost: independent_rays * truncation^2 / 2 * cost.
double negative_log_likelihood(const PixelCost& cost, const PixelCostOptions& options);

}  // namespace nearpose
