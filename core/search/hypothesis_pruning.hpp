// Screening of many guessed poses before any view is cast: from all, weighed at a glance, to the few that are wanted.
#pragma once

#include <vector>

#include "core/search/closest_point_grid.hpp"
#include "core/search/surfels.hpp"

namespace nearpose {

struct PoseHypothesis {
    Pose camera_from_object;
    double share = 0.0;  // of the measured points that lie on the model, in 0..1; tells close up. 0: no pose
    double gain = 0.0;   // of the model's points, see evidence_gain; tells a part among other things
};

// What all hypotheses are held against.
struct PruningScene {
    const ClosestPointGrid& surface;
    const SurfelGrid& surfels;
    const PinholeCamera& camera;
    std::vector<OrientedPoint> measured;  // balanced_sample of the surfels
    std::vector<OrientedPoint> model;     // some of its surface; empty: the share alone decides
    double tolerance_m = 0.0;             // within which model and depth agree, as a start
    double diameter_m = 0.0;              // of the model
    int num_threads = 1;
};

// About `count` of the measured oriented points, as often as they tell something: a plane that fills the view gives
// few. The first ones are spread over the image as all are.
std::vector<OrientedPoint> balanced_sample(const SurfelGrid& surfels, std::size_t count);

// How many more of the model's points (the first `count`) that face the camera lie within the tolerance of the measured
// surface than lie before it, where the sensor looked through them; each counts with the cosine of its slope and, where
// it agrees, with the weight of the surfel. Those deep before it count up to three times, those behind something say
// nothing: they may be hidden.
double evidence_gain(const PruningScene& scene, const Pose& camera_from_object, std::size_t count, double tolerance_m);

// A first look, which costs a microsecond.
PoseHypothesis coarsely_scored(const PruningScene& scene, const Pose& camera_from_object);

// The fewer are left, the closer each is looked at, and those that are near the object are pulled onto it on the way.
// Best by share and best by gain in turns, at most one from each coarse cell of poses; `count` or fewer.
std::vector<Pose> prune(std::vector<PoseHypothesis> hypotheses, const PruningScene& scene, int count);

}  // namespace nearpose
