// Where the particles start.
#pragma once

#include <cstdint>
#include <vector>

#include "core/filter/particles.hpp"
#include "core/observation/observation.hpp"
#include "core/search/oriented_point.hpp"
#include "core/view_generator.hpp"

namespace nearpose {

// The paper's start: viewpoints on a sphere around the observed object, its radius the cloud's mean distance, all
// orientations and rolls. That is, the model's box centre lies on the ray to the cloud's centroid at that distance, in
// a uniformly random orientation. Particle i draws from the stream (seed, step, i). `observation` must hold points.
ParticleSet sample_on_sphere(const Observation& observation, const ModelExtent& extent, int count, std::uint64_t seed,
                             std::uint64_t step);

// Around a given pose, with the given spread about the model's centre; particle 0 is the pose itself.
ParticleSet sample_around(const Pose& camera_from_object, const Diffusion& spread, const ModelExtent& extent, int count,
                          std::uint64_t seed, std::uint64_t step);

// The start for a partial view: a random point_of_model of the model is laid on a random measured point, normal on
// normal, with a random turn about it. Needs no object centre, which a close camera does not see. Particle i draws from
// the stream (seed, step, first_stream + i). Empty where there are no points or no measured normals.
ParticleSet sample_on_surface(const Observation& observation, const std::vector<OrientedPoint>& points, int count,
                              std::uint64_t seed, std::uint64_t step, std::uint64_t first_stream);

// Moves `camera_from_object` so that the centroid of the surface that a view of it shows lies on the observed cloud's:
// the model's origin, its box centre and the seen surface may be decimetres apart.
Pose shift_to_seen_surface(const Pose& camera_from_object, const Observation& observation, const ViewGenerator& views,
                           const PinholeCamera& view_camera);

}  // namespace nearpose
