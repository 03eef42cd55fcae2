// Views as one writes them first: one ray after another.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/base/camera.hpp"
#include "core/base/pose.hpp"
#include "tests/bench/naive/embree_rays.hpp"

namespace nearpose::bench::naive {

struct SeenSurface {
    std::vector<Eigen::Vector3f> points_in_object;   // [m]
    std::vector<Eigen::Vector3f> normals_in_object;  // unit, towards the camera
};

class SingleRayViews {
  public:
    explicit SingleRayViews(const Mesh& mesh) : scene_(mesh) {}

    SeenSurface generate(const Pose& camera_from_object, const PinholeCamera& camera) const;

  private:
    TriangleScene scene_;
};

// Every fourth pixel in each direction: 160 x 120 rays for an image of 640 x 480.
PinholeCamera quarter_camera(const PinholeCamera& camera);

}  // namespace nearpose::bench::naive
