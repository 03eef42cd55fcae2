// Port: how a pose becomes a view of the model (the paper's "fast online view generation").
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/base/camera.hpp"
#include "core/base/pose.hpp"

namespace nearpose {

// The points of the model that a camera at a pose sees. All vectors have the same length. Normals are of unit length
// and point to the side that the camera sees.
struct View {
    std::vector<Eigen::Vector3f> points_in_object;   // [m]
    std::vector<Eigen::Vector3f> normals_in_object;  // unit
    std::vector<int> pixels;                         // row-major index into the camera's image, each at most once
    // Made of samples of the surface: points lie within their pixels, not on the pixels' rays, and pixels may be
    // missing.
    bool of_samples = false;

    std::size_t size() const { return points_in_object.size(); }
};

// What the estimator needs to know of the model's shape; its scale comes from here, never from a constant.
struct ModelExtent {
    Eigen::Vector3d box_min_in_object = Eigen::Vector3d::Zero();  // [m]
    Eigen::Vector3d box_max_in_object = Eigen::Vector3d::Zero();  // [m]

    Eigen::Vector3d centre_in_object() const { return 0.5 * (box_min_in_object + box_max_in_object); }
    double diameter_m() const { return (box_max_in_object - box_min_in_object).norm(); }  // of the box
};

// Implementations are immutable after construction and may be called from several threads at once.
class ViewGenerator {
  public:
    virtual ~ViewGenerator() = default;

    // The view of the model at `camera_from_object` in the image of `camera`, cropped by that image. Empty if nothing
    // is in view. The pose must be valid (see is_valid); the same arguments give the same bits on one machine.
    virtual View generate(const Pose& camera_from_object, const PinholeCamera& camera) const = 0;

    virtual const ModelExtent& extent() const = 0;
};

}  // namespace nearpose
