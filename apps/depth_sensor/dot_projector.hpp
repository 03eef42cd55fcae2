// The projector of an active stereo camera: random dots that fall on what nothing hides from it.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "apps/depth_sensor/stereo_rig.hpp"
#include "core/base/camera.hpp"
#include "core/base/pose.hpp"
#include "raycast/depth_renderer.hpp"

namespace nearpose::simulate {

// The exact image of the scene from a viewpoint near the left camera, with its axes or others.
using RenderFrom = std::function<RenderedImage(const Pose& viewpoint_from_left, const PinholeCamera& camera)>;

// The dots in the projector's image: one in each cell of a lattice, at a random place and of a random brightness. The
// same seed gives the same dots.
class DotPattern {
  public:
    DotPattern(const StereoRig& rig, std::uint64_t seed);

    // Brightness in the direction (x, y, 1) from the projector, 1 in the middle of a mean dot. 0 beside its field of
    // view.
    double at(double x, double y) const;

  private:
    struct Dot {
        double x, y, brightness;
    };
    double half_width_, half_height_;
    double squared_sigma_;
    double cell_width_, cell_height_;
    int columns_, rows_;
    std::vector<Dot> dots_;
};

class DotProjector {
  public:
    // Renders the scene from the projector, as finely as `camera` sees it.
    DotProjector(const RenderFrom& render, const PinholeCamera& camera, const StereoRig& rig, std::uint64_t seed);

    // The light that arrives at a point in the left camera's axes [m] from the projector, on a surface turned to it; 1
    // in the middle of a mean dot at 1 m.
    double light_at(const Eigen::Vector3d& point_in_left) const;

    // Place in the left camera's axes [m].
    const Eigen::Vector3d& position_in_left() const { return position_in_left_; }

  private:
    bool reaches(const Eigen::Vector3d& point_in_projector) const;

    Eigen::Vector3d position_in_left_;
    DotPattern pattern_;
    PinholeCamera shadow_camera_;
    RenderedImage lit_;  // the nearest surfaces from the projector
};

}  // namespace nearpose::simulate
