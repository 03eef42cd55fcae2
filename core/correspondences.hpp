// Pairs of a view's points and measured points: what association makes and a pose solver takes.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace nearpose {

// Parallel arrays; entry k pairs a point of the model with a measured one.
struct Correspondences {
    std::vector<Eigen::Vector3f> points_in_object;   // of the view [m]
    std::vector<Eigen::Vector3f> normals_in_object;  // of the view, unit
    std::vector<Eigen::Vector3f> points_in_camera;   // measured [m]
    std::vector<Eigen::Vector3f> normals_in_camera;  // measured, unit; zero where unknown; empty: not looked up
    std::vector<float> sigmas_m;                     // standard deviation of the measured depth [m]

    std::size_t size() const { return points_in_object.size(); }
};

}  // namespace nearpose
