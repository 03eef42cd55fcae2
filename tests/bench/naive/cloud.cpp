#include "tests/bench/naive/cloud.hpp"

#include <Eigen/Eigenvalues>
#include <flann/flann.hpp>

namespace nearpose::bench::naive {

struct CloudIndex::Tree {
    explicit Tree(const flann::Matrix<float>& rows) : index(rows, flann::KDTreeSingleIndexParams(kLeafSize)) {
        index.buildIndex();
    }

    static constexpr int kLeafSize = 15;
    flann::Index<flann::L2_Simple<float>> index;
};

std::vector<Eigen::Vector3f> thinned(const std::vector<Eigen::Vector3f>& points, int count) {
    if (static_cast<int>(points.size()) <= count) return points;
    std::vector<Eigen::Vector3f> kept;
    for (int k = 0; k < count; ++k) kept.push_back(points[static_cast<std::size_t>(k) * points.size() / count]);
    return kept;
}

std::vector<Eigen::Vector3f> back_project(const DepthImage& depth, const Mask& mask, const PinholeCamera& camera) {
    std::vector<Eigen::Vector3f> points;
    for (int v = 0; v < camera.height; ++v) {
        for (int u = 0; u < camera.width; ++u) {
            const auto pixel = static_cast<std::size_t>(v * camera.width + u);
            if (mask.value[pixel] == 0 || !(depth.depth_m[pixel] > 0.0F)) continue;
            points.push_back((depth.depth_m[pixel] * camera.ray(u, v)).cast<float>());
        }
    }
    return points;
}

CloudIndex::CloudIndex(std::vector<Eigen::Vector3f> points_in_camera) : points_(std::move(points_in_camera)) {
    tree_ = std::make_unique<Tree>(flann::Matrix<float>(points_.front().data(), points_.size(), 3));
}

CloudIndex::~CloudIndex() = default;

std::vector<int> CloudIndex::nearest_k(const Eigen::Vector3f& query_in_camera, int k) const {
    Eigen::Vector3f query = query_in_camera;
    std::vector<int> indices(static_cast<std::size_t>(k));
    std::vector<float> squared_distances(static_cast<std::size_t>(k));
    flann::Matrix<int> index_row(indices.data(), 1, static_cast<std::size_t>(k));
    flann::Matrix<float> distance_row(squared_distances.data(), 1, static_cast<std::size_t>(k));
    tree_->index.knnSearch(flann::Matrix<float>(query.data(), 1, 3), index_row, distance_row,
                           static_cast<std::size_t>(k), flann::SearchParams(-1, 0.0F));
    return indices;
}

int CloudIndex::nearest(const Eigen::Vector3f& query_in_camera, float max_distance_m) const {
    const int index = nearest_k(query_in_camera, 1).front();
    const float distance_m = (points_[static_cast<std::size_t>(index)] - query_in_camera).norm();
    return distance_m <= max_distance_m ? index : -1;
}

std::vector<Eigen::Vector3f> estimate_normals(const CloudIndex& index) {
    constexpr int kNeighbours = 10;
    std::vector<Eigen::Vector3f> normals;
    for (const Eigen::Vector3f& point : index.points()) {
        const std::vector<int> near = index.nearest_k(point, kNeighbours);
        Eigen::Vector3d mean = Eigen::Vector3d::Zero();
        for (const int k : near) mean += index.points()[static_cast<std::size_t>(k)].cast<double>() / kNeighbours;
        Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
        for (const int k : near) {
            const Eigen::Vector3d off = index.points()[static_cast<std::size_t>(k)].cast<double>() - mean;
            spread += off * off.transpose();
        }
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);
        const Eigen::Vector3f normal = solver.eigenvectors().col(0).cast<float>();
        normals.push_back(normal.dot(point) > 0.0F ? Eigen::Vector3f(-normal) : normal);
    }
    return normals;
}

}  // namespace nearpose::bench::naive
