#include "core/search/point_pair_table.hpp"

#include <algorithm>
#include <cmath>

#include "core/search/surfels.hpp"

namespace nearpose {

AngleCells::AngleCells(int count)
    : count_(count), smallest_cosine_(static_cast<std::size_t>(count)), cell_at_largest_(kBins) {
    for (int cell = 0; cell < count; ++cell)
        smallest_cosine_[cell] = static_cast<float>(std::cos(M_PI * (cell + 1) / count));
    for (int bin = 0, cell = count - 1; bin < kBins; ++bin) {
        const float largest = static_cast<float>(bin + 1) / kBinsPerUnit - 1.0F;
        while (cell > 0 && largest > smallest_cosine_[cell - 1]) --cell;
        cell_at_largest_[bin] = cell;
    }
}

PointPairTable::PointPairTable(const ViewGenerator& views, const SearchOptions& options)
    : options_(options.point_pair_table),
      angle_cells_(options_.angle_cells),
      points_(sample_surface(views, options.surface_points)),
      surface_(views, options.closest_point_grid),
      diameter_m_(views.extent().diameter_m()),
      cells_(static_cast<std::size_t>(options_.distance_cells) * angle_cells_.count() * angle_cells_.count() *
             angle_cells_.count()) {
    const int count = static_cast<int>(points_.size());
    const int every = std::max(1, count / options_.max_points);
    for (int i = 0; i < count; i += every) {
        for (int j = 0; j < count; j += every) {
            const int cell = i == j ? -1 : cell_of(points_[i], points_[j]);
            if (cell >= 0) cells_[cell].push_back({i, j});
        }
    }
    largest_face_m2_ = largest_face(points_, options_.face.tolerance_diameters * diameter_m_, options_.face);
}

int PointPairTable::cell_of(const OrientedPoint& first, const OrientedPoint& second) const {
    const Eigen::Vector3f line = second.point - first.point;
    const double distance = line.norm();
    const double place = (distance / diameter_m_ - options_.min_distance_diameters) /
                         (options_.max_distance_diameters - options_.min_distance_diameters);  // in 0..1
    if (!(place >= 0.0 && place < 1.0)) return -1;
    const Eigen::Vector3f direction = line / static_cast<float>(distance);
    int cell = static_cast<int>(place * options_.distance_cells);
    for (const float cosine :
         {first.normal.dot(direction), second.normal.dot(direction), first.normal.dot(second.normal)})
        cell = cell * angle_cells_.count() + angle_cells_(cosine);
    return cell;
}

const std::vector<PointPairTable::Pair>& PointPairTable::matches(const OrientedPoint& first,
                                                                 const OrientedPoint& second) const {
    static const std::vector<Pair> kNone;
    const int cell = cell_of(first, second);
    return cell < 0 ? kNone : cells_[cell];
}

}  // namespace nearpose
