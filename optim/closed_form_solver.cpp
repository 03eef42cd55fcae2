#include "optim/closed_form_solver.hpp"

#include <Eigen/SVD>
#include <cmath>

#include "optim/internal/registration_cost.hpp"

namespace nearpose {
namespace {

constexpr std::size_t kMinPairs = 3;
// Second singular value of the cross moments by the first: below it the points lie on a line to single precision.
constexpr double kLineRatio = 1e-7;

struct WeightedMoments {
    Eigen::Vector3d object_mean = Eigen::Vector3d::Zero();
    Eigen::Vector3d camera_mean = Eigen::Vector3d::Zero();
    Eigen::Matrix3d cross = Eigen::Matrix3d::Zero();  // camera by object, about the means
};

WeightedMoments weighted_moments(const NormalisedPairs& pairs) {
    WeightedMoments moments;
    for (const NormalisedPairs::Block& block : pairs.blocks) {
        const Eigen::Vector4d weights = block.weight.square();
        moments.object_mean += block.point_in_object.matrix().transpose() * weights;
        moments.camera_mean += block.point_in_camera.matrix().transpose() * weights;
    }
    moments.object_mean /= pairs.total_squared_weight;
    moments.camera_mean /= pairs.total_squared_weight;
    for (const NormalisedPairs::Block& block : pairs.blocks) {
        const Eigen::Matrix<double, NormalisedPairs::kLanes, 3> in_object =
            block.point_in_object.matrix().rowwise() - moments.object_mean.transpose();
        const Eigen::Matrix<double, NormalisedPairs::kLanes, 3> in_camera =
            block.point_in_camera.matrix().rowwise() - moments.camera_mean.transpose();
        moments.cross += in_camera.transpose() * block.weight.square().matrix().asDiagonal() * in_object;
    }
    return moments;
}

}  // namespace

SolveResult ClosedFormPoseSolver::solve(const Correspondences& pairs, const Pose& camera_from_object) const {
    SolveResult result{camera_from_object, 0.0, 0.0, SolveStatus::kNotUsable};
    if (pairs.size() < kMinPairs) {
        result.status = SolveStatus::kTooFewPairs;
        return result;
    }
    const NormalisedPairs normalised(pairs, ResidualKind::kPointToPoint);
    if (!normalised.usable || !is_valid(camera_from_object)) return result;

    const WeightedMoments moments = weighted_moments(normalised);
    const auto cost = [&normalised](const Pose& pose) {
        return 0.5 *
               registration_equations(normalised, pose, {ResidualKind::kPointToPoint, RobustLoss::kNone, 1.0}).rtr;
    };
    result.initial_cost = result.final_cost = cost(normalised.normalised(camera_from_object));
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(moments.cross, Eigen::ComputeFullU | Eigen::ComputeFullV);
    if (!(svd.singularValues()[1] > kLineRatio * svd.singularValues()[0])) return result;
    Eigen::Vector3d signs = Eigen::Vector3d::Ones();  // no reflection
    if ((svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0) signs.z() = -1.0;
    const Eigen::Matrix3d rotation = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();

    const Pose best{Eigen::Quaterniond(rotation).normalized(), moments.camera_mean - rotation * moments.object_mean};
    const double best_cost = cost(best);
    const Pose found = normalised.metric(best);
    if (!std::isfinite(best_cost) || !is_valid(found)) return result;
    result.status = SolveStatus::kConverged;
    // At the minimum already: rounding must not make it worse.
    if (best_cost > result.initial_cost) return result;
    result.camera_from_object = found;
    result.final_cost = best_cost;
    return result;
}

}  // namespace nearpose
