// The pairs of a solve, checked and in coordinates and an order in memory that suit the solvers. Not installed.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/base/pose.hpp"
#include "core/correspondences.hpp"
#include "optim/ceres_pose_solver.hpp"

namespace nearpose {

// The object's origin is moved to the centroid of the pairs and lengths are in units of their spread. A turn then moves
// the points as far as a shift of the same number does, and an object frame with a far origin does not couple the two.
struct NormalisedPairs {
    // Four pairs side by side: the sums over them need no shuffling within a register, and their order, hence their
    // rounding, is the same whatever the width of the registers.
    static constexpr int kLanes = 4;
    using Lanes = Eigen::Array<double, kLanes, 1>;
    using Lanes3 = Eigen::Array<double, kLanes, 3>;
    struct Block {
        Lanes3 point_in_object = Lanes3::Zero();
        Lanes3 point_in_camera = Lanes3::Zero();
        Lanes3 weighted_normal = Lanes3::Zero();  // in the object's frame, times weight
        Lanes weight = Lanes::Zero();             // 1 / sigma, sigma in units of length_m; 0 fills up the last block
    };

    NormalisedPairs(const Correspondences& correspondences, ResidualKind kind);

    // The pose between the normalised coordinates, and back.
    Pose normalised(const Pose& camera_from_object) const;
    Pose metric(const Pose& normalised_pose) const;

    std::vector<Block> blocks;
    Eigen::Vector3d centre_in_object = Eigen::Vector3d::Zero();  // [m]
    double length_m = 1.0;              // root mean square distance of the points from the centre
    double total_squared_weight = 0.0;  // the order of the largest eigenvalue of the normal equations
    bool usable = false;                // every number that `kind` uses is finite, every sigma positive

  private:
    bool set_frame(const Correspondences& correspondences, bool with_normals);
};

}  // namespace nearpose
