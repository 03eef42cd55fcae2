#include "tests/bench/naive/least_squares.hpp"

#include <ceres/ceres.h>

#include <Eigen/Geometry>

namespace nearpose::bench::naive {
namespace {

// Ambient: quaternion x y z w, then translation [m].
struct PointToPoint {
    const Pair& pair;

    template <typename T>
    bool operator()(const T* pose, T* residuals) const {
        const Eigen::Map<const Eigen::Quaternion<T>> rotation(pose);
        const Eigen::Map<const Eigen::Matrix<T, 3, 1>> translation(pose + 4);
        Eigen::Map<Eigen::Matrix<T, 3, 1>> difference(residuals);
        difference = rotation * pair.point_in_object.cast<T>() + translation - pair.point_in_camera.cast<T>();
        return true;
    }
};

struct PointToPlane {
    const Pair& pair;

    template <typename T>
    bool operator()(const T* pose, T* residual) const {
        const Eigen::Map<const Eigen::Quaternion<T>> rotation(pose);
        const Eigen::Map<const Eigen::Matrix<T, 3, 1>> translation(pose + 4);
        const Eigen::Matrix<T, 3, 1> difference =
            rotation * pair.point_in_object.cast<T>() + translation - pair.point_in_camera.cast<T>();
        residual[0] = (rotation * pair.normal_in_object.cast<T>()).dot(difference) / T(pair.sigma_m);
        return true;
    }
};

template <typename Functor, int kResiduals>
Pose solve(const std::vector<Pair>& pairs, const Pose& camera_from_object, bool robust) {
    constexpr double kLossScale = 2.0;
    Eigen::Matrix<double, 7, 1> pose;
    pose << camera_from_object.rotation.coeffs(), camera_from_object.translation;
    ceres::Problem problem;
    problem.AddParameterBlock(
        pose.data(), 7, new ceres::ProductManifold<ceres::EigenQuaternionManifold, ceres::EuclideanManifold<3>>());
    for (const Pair& pair : pairs) {
        problem.AddResidualBlock(new ceres::AutoDiffCostFunction<Functor, kResiduals, 7>(new Functor{pair}),
                                 robust ? new ceres::HuberLoss(kLossScale) : nullptr, pose.data());
    }
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_QR;
    options.max_num_iterations = 5;  // as nearpose's solver
    options.num_threads = 1;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    return {Eigen::Quaterniond(pose.data()).normalized(), pose.tail<3>()};
}

}  // namespace

Pose solve_point_to_point(const std::vector<Pair>& pairs, const Pose& camera_from_object) {
    return solve<PointToPoint, 3>(pairs, camera_from_object, false);
}

Pose solve_point_to_plane(const std::vector<Pair>& pairs, const Pose& camera_from_object) {
    return solve<PointToPlane, 1>(pairs, camera_from_object, true);
}

std::vector<Pair> sample_consensus(const std::vector<Pair>& pairs, int hypotheses, double max_distance_m,
                                   RandomStream random) {
    if (pairs.size() < 4) return pairs;
    const auto supports = [&](const Eigen::Isometry3d& camera_from_object, const Pair& pair) {
        const Eigen::Vector3d moved = camera_from_object * pair.point_in_object;
        return (moved - pair.point_in_camera).squaredNorm() <= max_distance_m * max_distance_m;
    };
    Eigen::Isometry3d best = Eigen::Isometry3d::Identity();
    int best_count = -1;
    for (int draw = 0; draw < hypotheses; ++draw) {
        Eigen::Matrix3d model, measured;
        for (int c = 0; c < 3; ++c) {
            const Pair& pair = pairs[static_cast<std::size_t>(random.below(static_cast<int>(pairs.size())))];
            model.col(c) = pair.point_in_object;
            measured.col(c) = pair.point_in_camera;
        }
        const Eigen::Isometry3d camera_from_object(Eigen::umeyama(model, measured, false));
        int count = 0;
        for (const Pair& pair : pairs) count += supports(camera_from_object, pair);
        if (count <= best_count) continue;
        best_count = count;
        best = camera_from_object;
    }
    std::vector<Pair> supporting;
    for (const Pair& pair : pairs)
        if (supports(best, pair)) supporting.push_back(pair);
    return supporting;
}

}  // namespace nearpose::bench::naive
