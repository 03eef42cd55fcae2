// Pose hypotheses from pairs of oriented points (point pair features, Drost et al. 2010): two measured points with
// their normals are aligned with two of the model that lie to each other as they do. The poses that agree best with the
// measured surface are kept, before any view is cast. So a part is found of which little is seen, or among other
// things.
#pragma once

#include <cstdint>
#include <vector>

#include "core/observation/observation.hpp"
#include "core/search/point_pair_table.hpp"
#include "core/search/search_options.hpp"
#include "core/search/surfels.hpp"

namespace nearpose {

// The surfels of an observation for a model; planes larger than any of its faces are found and weigh little.
SurfelGrid surfels_of(const Observation& observation, const PointPairTable& pairs, const SearchOptions& options,
                      std::uint64_t seed, std::uint64_t step);

// What one search asks for.
struct PairDraws {
    int draws = 0;                   // hypotheses
    int count = 0;                   // of poses that are wanted
    double share = 1.0;              // of a whole search, in 0..1; each stage of pruning keeps as much less
    std::uint64_t first_stream = 0;  // draw i uses the stream (seed, step, first_stream + i)
    int num_threads = 1;
};

// Draws pairs of the observation, each with a random pair of the model that matches, and some single points. Returns
// the poses that agree best with what is measured, aligned with it, best first, at most one from each cell of poses.
// There may be fewer than wanted.
std::vector<Pose> hypotheses_from_pairs(const Observation& observation, const PointPairTable& pairs,
                                        const SurfelGrid& surfels, const SearchOptions& options,
                                        const PairDraws& wanted, std::uint64_t seed, std::uint64_t step);

}  // namespace nearpose
