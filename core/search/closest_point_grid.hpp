// The model's surface on a voxel grid: which point of it is nearest, in one look-up. Measured points are compared with
// it and pulled onto it without casting a view; what the sensor sees through is not noticed here.
#pragma once

#include <vector>

#include "core/search/sampling.hpp"

namespace nearpose {

class ClosestPointGrid {
  public:
    // Looks at the model from all around.
    explicit ClosestPointGrid(const ViewGenerator& views);

    // The sampled point of the surface that is nearest, to within a voxel; null farther than about reach_m from it.
    const OrientedPoint* nearest(const Eigen::Vector3f& point_in_object) const {
        const Eigen::Vector3f at = (point_in_object - origin_in_object_) * voxels_per_m_;
        if (!(at.minCoeff() >= 0.0F)) return nullptr;
        const Eigen::Vector3f size = size_.cast<float>();
        if (!(at.x() < size.x() && at.y() < size.y() && at.z() < size.z())) return nullptr;
        const int sample = voxels_[index_of(at.cast<int>())];
        return sample < 0 ? nullptr : &samples_[static_cast<std::size_t>(sample)];
    }

    double reach_m() const { return reach_m_; }
    const Eigen::Vector3d& centre_in_object() const { return centre_in_object_; }

  private:
    std::size_t index_of(const Eigen::Vector3i& voxel) const {
        return (static_cast<std::size_t>(voxel.z()) * size_.y() + voxel.y()) * size_.x() + voxel.x();
    }
    void put_in(const std::vector<OrientedPoint>& surface);
    void spread(int rounds);

    std::vector<OrientedPoint> samples_;  // at most one for each voxel
    std::vector<int> voxels_;             // of samples_; -1: none near
    Eigen::Vector3f origin_in_object_ = Eigen::Vector3f::Zero();
    Eigen::Vector3d centre_in_object_;
    Eigen::Vector3i size_ = Eigen::Vector3i::Zero();
    float voxels_per_m_ = 0.0F;
    double reach_m_ = 0.0;
};

// Share of the measured points (with their normals, in camera coordinates) that lie on the model's surface to within
// the tolerance, in 0..1; of the first `count`.
double inlier_share_on(const ClosestPointGrid& field, const Pose& camera_from_object,
                       const std::vector<OrientedPoint>& measured, std::size_t count, double tolerance_m);

// camera_from_object after `rounds` point-to-plane steps that pull the measured points onto the model's surface.
Pose aligned_to_surface(const ClosestPointGrid& field, const Pose& camera_from_object,
                        const std::vector<OrientedPoint>& measured, int rounds, double tolerance_m);

}  // namespace nearpose
