// A part of known closed form for tests of the core: a union of boxes, seen by exact ray-box intersection, and a plain
// Gauss-Newton solver. With them the core is tested without any ray caster or solver library.
#pragma once

#include <vector>

#include "core/base/depth_image.hpp"
#include "core/pose_solver.hpp"
#include "core/view_generator.hpp"

namespace nearpose::test {

struct Box {
    Eigen::Vector3d min, max;  // [m]
};

// A base of 20 x 14 x 6 cm with two unequal towers: no symmetry.
std::vector<Box> asymmetric_part();

class BoxViewGenerator : public ViewGenerator {
  public:
    explicit BoxViewGenerator(std::vector<Box> boxes);

    View generate(const Pose& camera_from_object, const PinholeCamera& camera) const override;
    const ModelExtent& extent() const override { return extent_; }

  private:
    // Slab test; the ray's z is 1, so its parameter is the depth.
    double nearest_hit(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, Eigen::Vector3d& normal) const;

    std::vector<Box> boxes_;
    ModelExtent extent_;
};

// One damped Gauss-Newton step after another on point-to-plane residuals, weights falling off beyond two sigmas.
class GaussNewtonSolver : public PoseSolver {
  public:
    SolveResult solve(const Correspondences& pairs, const Pose& camera_from_object) const override;
};

PinholeCamera small_camera();

// Depth of the part before a wall at `wall_m`, and the mask of the part.
DepthImage render(const ViewGenerator& part, const Pose& pose, const PinholeCamera& camera, float wall_m, Mask* mask);

}  // namespace nearpose::test
