// The measured cloud and its nearest neighbours as one writes them first: FLANN's index, asked once a point.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "core/base/camera.hpp"
#include "core/base/depth_image.hpp"

namespace nearpose::bench::naive {

// At most `count` of the entries, evenly.
std::vector<Eigen::Vector3f> thinned(const std::vector<Eigen::Vector3f>& points, int count);

// The points of the mask's pixels, in camera coordinates [m].
std::vector<Eigen::Vector3f> back_project(const DepthImage& depth, const Mask& mask, const PinholeCamera& camera);

// Used as PCL's KdTreeFLANN uses it: a single k-d tree, leaves of 15, one matrix of one row a query.
class CloudIndex {
  public:
    explicit CloudIndex(std::vector<Eigen::Vector3f> points_in_camera);
    ~CloudIndex();

    // -1 where nothing is within `max_distance_m`.
    int nearest(const Eigen::Vector3f& query_in_camera, float max_distance_m) const;
    std::vector<int> nearest_k(const Eigen::Vector3f& query_in_camera, int k) const;
    const std::vector<Eigen::Vector3f>& points() const { return points_; }

  private:
    struct Tree;
    std::vector<Eigen::Vector3f> points_;
    std::unique_ptr<Tree> tree_;
};

// A normal for each point: the direction of least spread among its 10 nearest neighbours, towards the camera.
std::vector<Eigen::Vector3f> estimate_normals(const CloudIndex& index);

}  // namespace nearpose::bench::naive
