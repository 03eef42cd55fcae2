// Initial particles: drawn around the observed object, around a given pose, or on the observed surface.
#pragma once

#include <cstdint>
#include <vector>

#include "core/filter/particles.hpp"
#include "core/observation/observation.hpp"
#include "core/search/oriented_point.hpp"
#include "core/view_generator.hpp"

namespace nearpose {

// The paper's initialisation: viewpoints on a sphere around the observed object, with all rolls. The sphere's radius is
// the mean distance of the measured points. So the model's box centre lies on the ray to their centroid, at that
// distance, in a uniformly random orientation. Particle i draws from the stream (seed, step, i). `observation` must
// hold points.
ParticleSet sample_on_sphere(const Observation& observation, const ModelExtent& extent, int count, std::uint64_t seed,
                             std::uint64_t step);

// Around a given pose, with the given spread about the model's centre. Particle 0 is the pose itself.
ParticleSet sample_around(const Pose& camera_from_object, const Diffusion& spread, const ModelExtent& extent, int count,
                          std::uint64_t seed, std::uint64_t step);

// For a partial view: a random point of the model is aligned with a random measured point, normal on normal, with a
// random turn about the normal. Needs no object centre, which a close camera does not see. Particle i draws from the
// stream (seed, step, first_stream + i). Empty where the model has no points, or nothing shows a normal.
ParticleSet sample_on_surface(const Observation& observation, const std::vector<OrientedPoint>& model, int count,
                              std::uint64_t seed, std::uint64_t step, std::uint64_t first_stream);

// Shifts `camera_from_object` so that the centroid of the surface seen in a view of it lies on that of the measured
// points. The model's origin, its box centre and the seen surface may be decimetres apart.
Pose shift_to_seen_surface(const Pose& camera_from_object, const Observation& observation, const ViewGenerator& views,
                           const PinholeCamera& view_camera);

}  // namespace nearpose
