#include "core/point_index.hpp"

#include <flann/flann.hpp>
#include <stdexcept>

namespace nearpose {

struct PointIndex::Tree {
    using Index = flann::KDTreeSingleIndex<flann::L2_3D<float>>;

    Eigen::Vector3f mean = Eigen::Vector3f::Zero();
    std::vector<float> coordinates;  // relative to the mean: far from the origin a float loses centimetres
    std::unique_ptr<Index> index;    // none for an empty cloud, which the library does not survive
};

PointIndex::PointIndex(const std::vector<Eigen::Vector3f>& points) : tree_(std::make_unique<Tree>()) {
    if (points.empty()) return;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3f& point : points) {
        if (!point.allFinite()) throw std::invalid_argument("PointIndex: the cloud holds a point that is not finite");
        sum += point.cast<double>();
    }
    tree_->mean = (sum / static_cast<double>(points.size())).cast<float>();
    tree_->coordinates.reserve(3 * points.size());
    for (const Eigen::Vector3f& point : points) {
        const Eigen::Vector3f relative = point - tree_->mean;
        tree_->coordinates.insert(tree_->coordinates.end(), relative.data(), relative.data() + 3);
    }
    const flann::Matrix<float> rows(tree_->coordinates.data(), points.size(), 3);
    constexpr int kLeafSize = 12;
    tree_->index = std::make_unique<Tree::Index>(rows, flann::KDTreeSingleIndexParams(kLeafSize));
    tree_->index->buildIndex();
}

PointIndex::~PointIndex() = default;
PointIndex::PointIndex(PointIndex&&) noexcept = default;
PointIndex& PointIndex::operator=(PointIndex&&) noexcept = default;

std::vector<PointIndex::Neighbour> PointIndex::nearest(const std::vector<Eigen::Vector3f>& queries) const {
    std::vector<Neighbour> found(queries.size());
    if (!tree_->index || queries.empty()) return found;
    // Queries that are not finite are never sent: the library leaves rubbish in their place.
    std::vector<float> rows;
    std::vector<int> query_of_row;
    rows.reserve(3 * queries.size());
    query_of_row.reserve(queries.size());
    for (std::size_t q = 0; q < queries.size(); ++q) {
        if (!queries[q].allFinite()) continue;
        const Eigen::Vector3f relative = queries[q] - tree_->mean;
        rows.insert(rows.end(), relative.data(), relative.data() + 3);
        query_of_row.push_back(static_cast<int>(q));
    }
    if (query_of_row.empty()) return found;
    std::vector<int> ids(query_of_row.size(), -1);
    std::vector<float> distances(query_of_row.size(), 0.0F);
    const flann::Matrix<float> query_rows(rows.data(), query_of_row.size(), 3);
    flann::Matrix<int> id_rows(ids.data(), ids.size(), 1);
    flann::Matrix<float> distance_rows(distances.data(), distances.size(), 1);
    flann::SearchParams exact_and_serial(flann::FLANN_CHECKS_UNLIMITED, 0.0F, false);
    exact_and_serial.cores = 1;  // the loop over particles is the parallel one
    tree_->index->knnSearch(query_rows, id_rows, distance_rows, 1, exact_and_serial);
    for (std::size_t r = 0; r < ids.size(); ++r) found[query_of_row[r]] = {ids[r], distances[r]};
    return found;
}

}  // namespace nearpose
