// The model's surface on a voxel grid: which of its points is nearest, in one look-up. Hypotheses are scored and
// aligned with it without casting a view. It holds no free space: that the sensor looked through the model is not
// noticed here.
#pragma once

#include <vector>

#include "core/search/oriented_point.hpp"
#include "core/search/search_options.hpp"

namespace nearpose {

class ClosestPointGrid {
  public:
    explicit ClosestPointGrid(const ViewGenerator& views, const ClosestPointGridOptions& options = {});

    // The sampled point of the surface (in the object's frame) that is nearest, to within a voxel; null farther than
    // about reach_m() from it.
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
    void insert(const std::vector<OrientedPoint>& surface);
    void propagate(int rounds);
    void take_nearest_of_neighbours(const Eigen::Vector3i& voxel, const std::vector<int>& before);

    std::vector<OrientedPoint> samples_;                          // in the object's frame, at most one for each voxel
    std::vector<int> voxels_;                                     // each an index into samples_; -1: none is near
    Eigen::Vector3f origin_in_object_ = Eigen::Vector3f::Zero();  // the grid's corner
    Eigen::Vector3d centre_in_object_;                            // of the model's box
    Eigen::Vector3i size_ = Eigen::Vector3i::Zero();
    float voxels_per_m_ = 0.0F;
    double reach_m_ = 0.0;
};

// Share in 0..1 of the first `count` measured points (in camera coordinates) that lie on the model's surface: within
// the tolerance of it, with about the same normal.
double inlier_share(const ClosestPointGrid& grid, const Pose& camera_from_object,
                    const std::vector<OrientedPoint>& measured, std::size_t count, double tolerance_m,
                    const InlierOptions& options = {});

// camera_from_object after `rounds` of point-to-plane ICP (Chen and Medioni 1992) that align the measured points (in
// camera coordinates) with the model's surface.
Pose align_to_surface(const ClosestPointGrid& grid, const Pose& camera_from_object,
                      const std::vector<OrientedPoint>& measured, int rounds, double tolerance_m,
                      const AlignmentOptions& options = {});

}  // namespace nearpose
