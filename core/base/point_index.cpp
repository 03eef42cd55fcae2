#include "core/base/point_index.hpp"

#include <flann/flann.hpp>
#include <stdexcept>

namespace nearpose {
namespace {

// The one nearest point so far. It begins with the limit, so that branches beyond it are never entered.
class Nearest : public flann::ResultSet<float> {
  public:
    explicit Nearest(float limit_m2) : limit_m2_(limit_m2) {}

    bool full() const override { return true; }
    void addPoint(float squared_distance_m2, std::size_t index) override {
        if (!(squared_distance_m2 < limit_m2_)) return;
        limit_m2_ = squared_distance_m2;
        index_ = static_cast<int>(index);
    }
    float worstDist() const override { return limit_m2_; }

    PointIndex::Neighbour found() const {
        return index_ < 0 ? PointIndex::Neighbour{} : PointIndex::Neighbour{index_, limit_m2_};
    }

  private:
    float limit_m2_;
    int index_ = -1;
};

}  // namespace

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

std::vector<PointIndex::Neighbour> PointIndex::nearest(const std::vector<Eigen::Vector3f>& queries,
                                                       float max_distance_m) const {
    std::vector<Neighbour> found(queries.size());
    if (!tree_->index) return found;
    const float limit_m2 = max_distance_m * max_distance_m;
    const flann::SearchParams exact(flann::FLANN_CHECKS_UNLIMITED, 0.0F, false);
    for (std::size_t q = 0; q < queries.size(); ++q) {
        // Queries that are not finite are never sent: the library leaves rubbish in their place.
        if (!queries[q].allFinite()) continue;
        const Eigen::Vector3f relative = queries[q] - tree_->mean;
        Nearest nearest(limit_m2);
        tree_->index->findNeighbors(nearest, relative.data(), exact);
        found[q] = nearest.found();
    }
    return found;
}

}  // namespace nearpose
