#include "core/information.hpp"

#include <Eigen/Cholesky>
#include <cmath>

namespace nearpose {
namespace {

Twist jacobian_of(const Correspondences& pairs, std::size_t k) {
    const Eigen::Vector3d point = pairs.points_in_object[k].cast<double>();
    const Eigen::Vector3d normal = pairs.normals_in_object[k].cast<double>();
    Twist jacobian;
    jacobian << point.cross(normal), normal;
    return jacobian;
}

}  // namespace

Matrix6d information_of(const Correspondences& pairs) {
    Matrix6d information = Matrix6d::Zero();
    for (std::size_t k = 0; k < pairs.size(); ++k) {
        const Twist jacobian = jacobian_of(pairs, k);
        const double sigma_m = pairs.sigmas_m[k];
        information.noalias() += jacobian * jacobian.transpose() / (sigma_m * sigma_m);
    }
    return information;
}

Matrix6d covariance_of(const Correspondences& pairs, const CovarianceOptions& options) {
    // The estimate averages the pairs with weights 1/sigma^2, so its error from a shared error s per patch of k rays is
    // A^-1 B A^-1 with A the information and B = k s^2 sum J^T J / sigma^4.
    Matrix6d A = information_of(pairs);
    Matrix6d B = A;
    const double shared = options.rays_per_shared_error * options.systematic_sigma_m * options.systematic_sigma_m;
    for (std::size_t k = 0; k < pairs.size(); ++k) {
        const Twist jacobian = jacobian_of(pairs, k);
        B.noalias() +=
            shared * std::pow(static_cast<double>(pairs.sigmas_m[k]), -4.0) * jacobian * jacobian.transpose();
    }
    Twist prior;
    prior << Eigen::Vector3d::Constant(std::pow(options.prior_rotation_rad, -2.0)),
        Eigen::Vector3d::Constant(std::pow(options.prior_translation_m, -2.0));
    A += prior.asDiagonal();
    B += prior.asDiagonal();
    const Matrix6d inverse = A.ldlt().solve(Matrix6d::Identity());
    const Matrix6d covariance = inverse * B * inverse;
    return 0.5 * (covariance + covariance.transpose());
}

}  // namespace nearpose
