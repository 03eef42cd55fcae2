// Nearest neighbours in a cloud (FLANN's single k-d tree, exact).
#pragma once

#include <Eigen/Core>
#include <limits>
#include <memory>
#include <vector>

namespace nearpose {

// Immutable after construction; queries may run from several threads at once.
class PointIndex {
  public:
    struct Neighbour {
        int index = -1;  // into the cloud; -1 where nothing is near or the query is not finite
        float squared_distance_m2 = 0.0F;
    };

    // Takes finite points only [m]: a NaN among them makes the tree answer wrongly. Throws std::invalid_argument.
    explicit PointIndex(const std::vector<Eigen::Vector3f>& points);
    ~PointIndex();
    PointIndex(PointIndex&&) noexcept;
    PointIndex& operator=(PointIndex&&) noexcept;

    // The nearest point of the cloud to each query, in the queries' order; none (index -1) where none is nearer than
    // `max_distance_m`. A limit spares most of the search for queries that lie far from the cloud.
    std::vector<Neighbour> nearest(const std::vector<Eigen::Vector3f>& queries,
                                   float max_distance_m = std::numeric_limits<float>::infinity()) const;

  private:
    struct Tree;
    std::unique_ptr<Tree> tree_;
};

}  // namespace nearpose
