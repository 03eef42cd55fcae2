// Pairs of a view's points and measured points: association and rejection (the paper's nearestNeighbors and
// rejectCorrespondences).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/base/pose.hpp"
#include "core/base/random.hpp"
#include "core/correspondences.hpp"
#include "core/observation/observation.hpp"
#include "core/view_generator.hpp"

namespace nearpose {

// For each point of the view the nearest measured point within `max_distance_m` of it at `camera_from_object`.
Correspondences associate_nearest(const View& view, const Pose& camera_from_object, const Observation& observation,
                                  double max_distance_m);

// For each point of the view the candidate pixel that it projects to, if their depths differ by `max_distance_m` at
// most. Right for point-to-plane residuals, whose pairs may slide along the surface; wrong for point-to-point.
// `extra_sigma_m` is added in quadrature to the sensor's noise: far from the solution every pair is uncertain by more.
Correspondences associate_projective(const View& view, const Pose& camera_from_object, const Observation& observation,
                                     double max_distance_m, double extra_sigma_m);

// Drops pairs whose normals differ by more than `max_angle_rad`; a pair without measured normal stays.
Correspondences reject_by_normal(const Correspondences& pairs, const Pose& camera_from_object, double max_angle_rad);

struct SampleConsensusOptions {
    int draws = 10;                // triples tried (the paper's source notes 10)
    double max_distance_m = 0.01;  // a pair within it under a triple's motion supports that triple
    double min_sine = 0.05;  // of the angle in a triple; the motion of a sliver is not defined about its long side
};

// Keeps the pairs that the best of `draws` random triples supports: each triple gives one rigid motion (Umeyama 1991).
// Returns `pairs` where there are fewer than four of them.
Correspondences reject_by_sample_consensus(const Correspondences& pairs, const SampleConsensusOptions& options,
                                           RandomStream random);

}  // namespace nearpose
