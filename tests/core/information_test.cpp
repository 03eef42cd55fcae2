#include "core/information.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>

#include "core/random.hpp"

namespace nearpose {
namespace {

// Points on the faces of a 20 cm cube, sigma 1 mm.
Correspondences cube_pairs(int count, bool one_face) {
    RandomStream random(1, 0, 0, RandomPurpose::kStart);
    Correspondences pairs;
    for (int k = 0; k < count; ++k) {
        const int axis = one_face ? 2 : k % 3;
        Eigen::Vector3f point(static_cast<float>(random.uniform(-0.1, 0.1)),
                              static_cast<float>(random.uniform(-0.1, 0.1)),
                              static_cast<float>(random.uniform(-0.1, 0.1)));
        Eigen::Vector3f normal = Eigen::Vector3f::Zero();
        const float side = one_face || random.uniform() < 0.5 ? 1.0F : -1.0F;
        point[axis] = 0.1F * side;
        normal[axis] = side;
        pairs.points_in_object.push_back(point);
        pairs.normals_in_object.push_back(normal);
        pairs.points_in_camera.push_back(point);
        pairs.sigmas_m.push_back(0.001F);
    }
    return pairs;
}

TEST(Information, AFlatFaceSaysNothingAboutSlidingAndTurningInItsPlane) {
    const Matrix6d information = information_of(cube_pairs(300, true));
    const Eigen::SelfAdjointEigenSolver<Matrix6d> spectrum(information);
    for (int k = 0; k < 3; ++k) EXPECT_LT(spectrum.eigenvalues()[k], 1e-6 * spectrum.eigenvalues()[5]);
    EXPECT_GT(spectrum.eigenvalues()[3], 1e-6 * spectrum.eigenvalues()[5]);
    EXPECT_NEAR(information(5, 5), 300.0 / 1e-6, 1e-3 / 1e-6) << "n / sigma^2 along the normal";
    EXPECT_NEAR(information(2, 2), 0.0, 1e-3) << "turning about the normal";
}

TEST(Information, CovariancePredictsTheScatterOfTheEstimate) {
    // Least squares on noisy pairs, many times: the scatter must be the covariance (independent noise only).
    const Correspondences pairs = cube_pairs(300, false);
    const Matrix6d covariance = covariance_of(pairs, {1.0, 0.0, 10.0, 10.0});
    const Matrix6d inverse = information_of(pairs).inverse();
    constexpr int kTrials = 3000;
    Matrix6d scatter = Matrix6d::Zero();
    for (int trial = 0; trial < kTrials; ++trial) {
        RandomStream random(2, trial, 0, RandomPurpose::kDiffusion);
        Twist b = Twist::Zero();
        for (std::size_t k = 0; k < pairs.size(); ++k) {
            Twist J;
            J << pairs.points_in_object[k].cross(pairs.normals_in_object[k]).cast<double>(),
                pairs.normals_in_object[k].cast<double>();
            b += J * (0.001 * random.gaussian()) / 1e-6;
        }
        const Twist error = inverse * b;
        scatter += error * error.transpose() / kTrials;
    }
    for (int k = 0; k < 6; ++k) EXPECT_NEAR(scatter(k, k) / covariance(k, k), 1.0, 0.12) << k;
}

TEST(Information, SharedErrorsAreNotAveragedAway) {
    // Rays of 1 mm noise each, and 0.5 mm shared by a patch. Four times the rays, four times as many a patch: the
    // independent part falls to a quarter, the shared part stays.
    const CovarianceOptions few{10.0, 0.0005, 10.0, 10.0}, many{40.0, 0.0005, 10.0, 10.0};
    const double a = covariance_of(cube_pairs(3000, false), few)(5, 5);
    const double b = covariance_of(cube_pairs(12000, false), many)(5, 5);
    EXPECT_NEAR(b / a, (1.0 / 4.0 + 10.0 * 0.25) / (1.0 + 10.0 * 0.25), 0.05);
}

TEST(Information, WhereThePairsSayNothingThePriorStays) {
    const Matrix6d covariance = covariance_of(cube_pairs(300, true), {1.0, 0.0, 0.5, 0.02});
    EXPECT_NEAR(std::sqrt(covariance(3, 3)), 0.02, 0.001);
    EXPECT_NEAR(std::sqrt(covariance(2, 2)), 0.5, 0.02);
    EXPECT_LT(std::sqrt(covariance(5, 5)), 0.001);
    EXPECT_NEAR(std::sqrt(covariance_of({}, {1.0, 0.0, 0.5, 0.02})(4, 4)), 0.02, 1e-9);
}

}  // namespace
}  // namespace nearpose
