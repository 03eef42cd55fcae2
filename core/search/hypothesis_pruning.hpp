// Pruning of many pose hypotheses before any view is cast: all are scored coarsely, fewer and fewer of them more
// closely, until as many are left as are wanted.
#pragma once

#include <vector>

#include "core/search/closest_point_grid.hpp"
#include "core/search/surfels.hpp"

namespace nearpose {

// A pose with two scores. Close up the share of the measured points says more, among other things that of the model's.
struct PoseHypothesis {
    Pose camera_from_object;
    double inlier_share = 0.0;  // of the measured points that lie on the model, in 0..1; 0: the hypothesis is dropped
    double model_score = 0.0;   // see model_score
};

// What all hypotheses are compared with.
struct PruningContext {
    const ClosestPointGrid& surface;  // the model's
    const SurfelGrid& surfels;
    const PinholeCamera& camera;
    std::vector<OrientedPoint> measured;  // in camera coordinates: a systematic_sample of the surfels
    std::vector<OrientedPoint> model;     // in the object's frame: some of its points; none: inlier_share alone decides
    double tolerance_m = 0.0;             // within which model and depth agree at first
    double diameter_m = 0.0;              // of the model
    int num_threads = 1;
    PruningOptions options = {};
};

// Support less penalty (compare Papazov and Burschka 2010) of those of the first `count` points of the model that face
// the camera. A point within the tolerance of the measured surface adds to it, one before it, where the sensor looked
// through it, takes away from it. Each counts with the cosine of its slope. Support also counts with the surfel's
// evidence weight, a penalty more where the point lies deep in free space. Occluded points count nothing.
double model_score(const PruningContext& context, const Pose& camera_from_object, std::size_t count,
                   double tolerance_m);

// Both scores by few points, in about a microsecond.
PoseHypothesis score_coarsely(const PruningContext& context, const Pose& camera_from_object);

// The best hypotheses after the stages of the options, which also align them with the model's surface; `count` or
// fewer. They are taken by both scores in turns, best first, at most one from each coarse cell of poses. Each stage
// keeps `share` of what the options say, in 0..1: for a part of a whole search.
std::vector<Pose> prune_hypotheses(std::vector<PoseHypothesis> hypotheses, const PruningContext& context, int count,
                                   double share = 1.0);

}  // namespace nearpose
