// Starts from pairs of oriented points: two measured points with their normals are laid on two of the model that lie to
// each other as they do (point pair features, Drost et al. 2010), and the poses that lay most of the measured points on
// the model are kept, before any view is cast. It finds a part of which little is seen, and a part among other things.
#pragma once

#include <cstdint>
#include <vector>

#include "core/observation/observation.hpp"
#include "core/search/point_pair_table.hpp"
#include "core/search/surfels.hpp"

namespace nearpose {

// Planes that are larger than any face of the model are found and given little weight.
SurfelGrid surfels_of(const Observation& observation, const PointPairTable& pairs, std::uint64_t seed,
                      std::uint64_t step);

struct PairSearchOptions {
    int draws = 40000;
    int count = 750;                 // of poses that are wanted
    std::uint64_t first_stream = 0;  // draw i uses the stream (seed, step, first_stream + i)
    int num_threads = 1;
};

// Random pairs of the observation, each with a random pair of the model that lies matches, and some single points; the
// poses that lay most of the measured surface on the model's, pulled onto it, best first, at most one from each cell of
// poses. May give fewer than wanted.
std::vector<Pose> hypotheses_from_pairs(const Observation& observation, const PointPairTable& pairs,
                                        const SurfelGrid& surfels, const PairSearchOptions& options, std::uint64_t seed,
                                        std::uint64_t step);

}  // namespace nearpose
