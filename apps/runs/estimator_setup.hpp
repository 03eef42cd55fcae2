// An estimator by the names and numbers that users give.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/estimator.hpp"
#include "core/evidence/verdict.hpp"
#include "core/method.hpp"
#include "core/pose_solver.hpp"
#include "core/view_generator.hpp"
#include "raycast/mesh.hpp"
#include "raycast/raster_view_generator.hpp"

namespace nearpose::program {

// "raycast": rays of the real camera against the mesh; "raster": the paper's rasteriser of surface samples, which hide
// each other as splats; "raster_cells": the same on a depth buffer with cells of the samples' size; "raster_as_rays":
// on one as fine as the view, whatever the samples; "sphere": a store of views from a sphere around the object;
// "spheres": from spheres of several radii.
const std::vector<std::string>& view_names();
// Whether views of this name are of samples of the surface, and the depth buffer of those that are.
bool is_rasteriser(const std::string& views);
RasterBuffer raster_buffer(const std::string& views);
// "default" and "paper".
const std::vector<std::string>& method_names();
// "point": point to point; "plane": point to plane.
const std::vector<std::string>& residual_names();

// Parts of the default method that an experiment can leave out, and what is done instead:
//   nothing     the whole method
//   fine_fit    the chosen mode stays as it was refined, without the joint fit and the track
//   outline     a face that is coplanar with its surroundings counts as found
//   depths      free-space violations cost the same at any depth; the pruning of hypotheses stays as it is
//   pairs       hypotheses come from single points of the surface and from the centroid
//   shortlist   a search refines its first hypotheses, not the best of many that were refined a little
//   rivals      no alternatives are tried beside the particles' own modes
//   confidence  an accepted pose yields to any better one, and its prediction is not fitted at once
//   doubts      only a pose that the image contradicts is searched for anew
//   economy     as many particles and rays in every frame as in the first
//   presence    planes are no null hypothesis: neither for the choice of a mode nor for the verdict
//   memory      alternatives are judged by each image alone
//   shared_errors  the verdict's agreement allows for no errors that neighbouring rays share
//   arm_check   images are not held against the arm's motion
//   repeated_image  an image that is the one before is taken for a new one
const std::vector<std::string>& parts_of_method();

struct EstimatorSetup {
    std::string method = "default";
    std::string views = "raycast";
    int particles = EstimatorOptions{}.num_particles;
    bool adaptive = true;   // the default method's: fewer particles in tracking
    double budget_s = 0.0;  // for an update; 0: none
    int threads = EstimatorOptions{}.num_threads;
    std::uint64_t seed = EstimatorOptions{}.seed;

    // Where they differ from the method. All are of the particles' step; the default method's start and refinement
    // keep their own rounds and take no sample consensus.
    std::optional<int> rounds;            // at least 1; 0 goes with gradient = false
    std::optional<int> consensus_draws;   // 0: no sample consensus
    std::optional<bool> overlap;          // the paper's cost alone: scaled by m / n, or the plain mean squared error
    std::optional<std::string> residual;  // of every solve
    bool gradient = true;  // false: nothing is ever solved, poses stay where diffusion puts them; nor is there a
                           // refinement of modes, which is nothing but solves
    // One part of the default method left out, for an ablation; "nothing": none. See parts_of_method().
    std::string without = "nothing";
    std::optional<int> view_samples;  // of the surface; the rasterisers' alone

    Symmetries symmetries;                            // of the part
    Tolerance tolerance;                              // of the verdict
    int max_sightings = SightingOptions{}.max_count;  // kept, to compare image and arm

    // For whoever feeds the estimator.
    bool use_mask = true;
    bool use_control = true;  // the measured motion of the camera
};

// All throw std::invalid_argument for a name that is not among these, a number out of bounds, and what does not go
// together.
std::shared_ptr<const ViewGenerator> make_view_generator(const EstimatorSetup& setup, const Mesh& mesh);
Method make_method(const EstimatorSetup& setup);
// Point to plane with a robust loss; for the paper's method point to point without one.
std::shared_ptr<const PoseSolver> make_solver(const EstimatorSetup& setup);
// `views` is what make_view_generator gave; several estimators may share it.
PoseEstimator make_estimator(const EstimatorSetup& setup, std::shared_ptr<const ViewGenerator> views);

}  // namespace nearpose::program
