// Pairs of oriented points of the model, looked up by how they lie to each other (point pair features, Drost et al.
// 2010).
#pragma once

#include <algorithm>
#include <vector>

#include "core/search/closest_point_grid.hpp"
#include "core/search/oriented_point.hpp"
#include "core/view_generator.hpp"

namespace nearpose {

// Which of some equal cells of 0..pi the angle of a cosine lies in. Cosines come in bins so narrow that each meets at
// most one border between cells, which makes it a look-up instead of an arc cosine. That holds for 25 cells or fewer.
class AngleCells {
  public:
    explicit AngleCells(int count);
    int count() const { return count_; }
    int operator()(float cosine) const {  // here, since setting up the table calls it millions of times
        const int bin = std::clamp(static_cast<int>((cosine + 1.0F) * kBinsPerUnit), 0, kBins - 1);
        const int cell = cell_at_largest_[bin];
        return std::min(count_ - 1, cell + (cosine < smallest_cosine_[cell] ? 1 : 0));
    }

  private:
    static constexpr float kBinsPerUnit = 128.0F;  // of the cosine
    static constexpr int kBins = 256;

    int count_;
    std::vector<float> smallest_cosine_;  // of each cell
    std::vector<int> cell_at_largest_;    // of each bin's largest cosine
};

// The model's oriented points, and pairs of them by their point pair feature: the distance, the angles of both normals
// to the line between the points, and the angle between the normals.
class PointPairTable {
  public:
    // Looks at the model from all around. Reads the search's options of points, pairs and grid.
    explicit PointPairTable(const ViewGenerator& views, const SearchOptions& options = {});

    struct Pair {
        int first = 0, second = 0;  // indices of points()
    };
    // The pairs with the same feature as the two oriented points, to within the cells of the table.
    const std::vector<Pair>& matches(const OrientedPoint& first, const OrientedPoint& second) const;

    const std::vector<OrientedPoint>& points() const { return points_; }  // in the object's frame
    const ClosestPointGrid& surface() const { return surface_; }
    double diameter_m() const { return diameter_m_; }
    double largest_face_m2() const { return largest_face_m2_; }  // of the model's planes
    // Bounds of the distance in a pair.
    double min_distance_m() const { return options_.min_distance_diameters * diameter_m_; }
    double max_distance_m() const { return options_.max_distance_diameters * diameter_m_; }

  private:
    int cell_of(const OrientedPoint& first, const OrientedPoint& second) const;  // -1: out of the table

    PointPairTableOptions options_;
    AngleCells angle_cells_;
    std::vector<OrientedPoint> points_;
    ClosestPointGrid surface_;
    double diameter_m_;
    double largest_face_m2_ = 0.0;
    std::vector<std::vector<Pair>> cells_;
};

}  // namespace nearpose
