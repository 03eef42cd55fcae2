// Starts from pairs of oriented points: two measured points with their normals are laid on two of the model that lie to
// each other as they do (point pair features, Drost et al. 2010), and the poses that lay most of the measured points on
// the model are kept, before any view is cast. It finds a part of which little is seen, and a part among other things.
#pragma once

#include <cstdint>
#include <vector>

#include "core/observation.hpp"
#include "core/patches.hpp"
#include "core/start.hpp"
#include "core/surface_field.hpp"

namespace nearpose {

// Pairs of the model's anchors by how they lie to each other: distance, the angles of both normals to the line between
// them, and the normals' angle to each other.
class AnchorPairs {
  public:
    // Looks at the model from all around; pairs from a tenth of its diameter to six tenths are kept.
    explicit AnchorPairs(const ViewGenerator& views);

    struct Pair {
        int first = 0, second = 0;  // of anchors()
    };
    // Those that lie to each other as the two oriented points do, to within the cells of the table.
    const std::vector<Pair>& alike(const SurfaceAnchor& first, const SurfaceAnchor& second) const;

    const std::vector<SurfaceAnchor>& anchors() const { return anchors_; }
    const SurfaceField& surface() const { return surface_; }
    double diameter_m() const { return diameter_m_; }
    double largest_face_m2() const { return largest_face_m2_; }  // of the model's planes
    double min_distance_m() const { return kMinDistance * diameter_m_; }
    double max_distance_m() const { return kMaxDistance * diameter_m_; }

  private:
    static constexpr double kMinDistance = 0.1, kMaxDistance = 0.6;              // diameters
    int cell_of(const SurfaceAnchor& first, const SurfaceAnchor& second) const;  // -1: out of the table

    std::vector<SurfaceAnchor> anchors_;
    SurfaceField surface_;
    double diameter_m_;
    double largest_face_m2_ = 0.0;
    std::vector<std::vector<Pair>> cells_;
};

// Planes that are larger than any face of the model are found and given little weight.
PatchGrid patches_of(const Observation& observation, const AnchorPairs& pairs, std::uint64_t seed, std::uint64_t step);

struct PairStartOptions {
    int draws = 40000;
    int count = 750;                 // of poses that are wanted
    std::uint64_t first_stream = 0;  // draw i uses the stream (seed, step, first_stream + i)
    int num_threads = 1;
};

// Random pairs of the observation, each with a random pair of the model that lies alike, and some single points; the
// poses that lay most of the measured surface on the model's, pulled onto it, best first, at most one from each cell of
// poses. May give fewer than wanted.
std::vector<Pose> start_on_pairs(const Observation& observation, const AnchorPairs& pairs, const PatchGrid& patches,
                                 const PairStartOptions& options, std::uint64_t seed, std::uint64_t step);

}  // namespace nearpose
