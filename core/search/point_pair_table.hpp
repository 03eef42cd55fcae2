// Pairs of oriented points of the model, looked up by how they lie to each other (point pair features, Drost et al.
// 2010).
#pragma once

#include <vector>

#include "core/search/closest_point_grid.hpp"
#include "core/search/oriented_point.hpp"
#include "core/view_generator.hpp"

namespace nearpose {

// Pairs of the model's points by how they lie to each other: distance, the angles of both normals to the line between
// them, and the normals' angle to each other.
class PointPairTable {
  public:
    // Looks at the model from all around; pairs from a tenth of its diameter to six tenths are kept.
    explicit PointPairTable(const ViewGenerator& views);

    struct Pair {
        int first = 0, second = 0;  // of points()
    };
    // Those that lie to each other as the two oriented points do, to within the cells of the table.
    const std::vector<Pair>& matches(const OrientedPoint& first, const OrientedPoint& second) const;

    const std::vector<OrientedPoint>& points() const { return points_; }
    const ClosestPointGrid& surface() const { return surface_; }
    double diameter_m() const { return diameter_m_; }
    double largest_face_m2() const { return largest_face_m2_; }  // of the model's planes
    double min_distance_m() const { return kMinDistance * diameter_m_; }
    double max_distance_m() const { return kMaxDistance * diameter_m_; }

  private:
    static constexpr double kMinDistance = 0.1, kMaxDistance = 0.6;              // diameters
    int cell_of(const OrientedPoint& first, const OrientedPoint& second) const;  // -1: out of the table

    std::vector<OrientedPoint> points_;
    ClosestPointGrid surface_;
    double diameter_m_;
    double largest_face_m2_ = 0.0;
    std::vector<std::vector<Pair>> cells_;
};

}  // namespace nearpose
