// Views taken from a store of views: the view sphere that ray casting is compared with.
#pragma once

#include <vector>

#include "core/view_generator.hpp"
#include "raycast/surface_samples.hpp"

namespace nearpose {

struct SphereOptions {
    int num_viewpoints = 642;
    double radius_in_diameters = 2.0;  // of the sphere of viewpoints, > 0.5
    int image_size = 64;               // side of the stored views [pixels]
};

// At construction the object is seen from viewpoints spread evenly on a sphere around the centre of its box, each time
// in the middle of the image and whole. A pose gets the stored view whose direction is nearest to its own, placed
// rigidly: yaw and pitch choose the view, roll and distance move it. It does not show what is hidden, uncovered or
// distorted because the camera is near or the object off the optical axis.
class SphereViewGenerator : public ViewGenerator {
  public:
    explicit SphereViewGenerator(const Mesh& mesh, const SphereOptions& options = {});

    View generate(const Pose& camera_from_object, const PinholeCamera& camera) const override;
    const ModelExtent& extent() const override { return extent_; }

    // The pose and the camera that stored view `index` was taken with.
    const Pose& stored_pose(int index) const { return poses_[static_cast<std::size_t>(index)]; }
    const PinholeCamera& stored_camera() const { return camera_; }

  private:
    int nearest_view(const Pose& camera_from_object) const;

    ModelExtent extent_;
    PinholeCamera camera_;
    std::vector<Pose> poses_;                  // camera_from_object
    std::vector<Eigen::Vector3d> directions_;  // unit, from the box's centre to the camera, object frame
    std::vector<SurfaceSamples> views_;
};

}  // namespace nearpose
