#include "core/evidence/observability.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace nearpose {
namespace {

constexpr double kRadius_m = 0.1, kWeak_m = 0.002;

Matrix6d diagonal(const Twist& sigmas) {
    return Matrix6d(sigmas.cwiseAbs2().asDiagonal());
}

TEST(Observability, NamesTheUndeterminedDirectionsWorstFirst) {
    Twist sigmas;  // a flat face, normal z: slides along x and y, turns about z
    sigmas << 0.001, 0.001, 0.5, 0.3, 0.2, 0.0001;
    const Observability observability = observability_of(diagonal(sigmas), kRadius_m, kWeak_m);
    EXPECT_EQ(observability.weak, (std::vector<std::string>{"slides along x", "slides along y", "turns about z"}));
    EXPECT_NEAR(observability.sigmas_m[0], 0.3, 1e-9);
    EXPECT_NEAR(observability.sigmas_m[2], 0.5 * kRadius_m, 1e-9)
        << "a rotation counts as the shift of a point at the radius";
    for (int k = 1; k < 6; ++k) EXPECT_LE(observability.sigmas_m[k], observability.sigmas_m[k - 1]);
}

TEST(Observability, NoDirectionIsWeakWhereAllAreDetermined) {
    const Observability observability = observability_of(diagonal(Twist::Constant(0.0001)), kRadius_m, kWeak_m);
    EXPECT_TRUE(observability.weak.empty());
}

TEST(Observability, DirectionsAreOrthonormalAndGiveTheCovarianceBack) {
    Matrix6d root;
    for (int i = 0; i < 36; ++i) root(i / 6, i % 6) = std::sin(1.0 + 7.3 * i) * 1e-3;
    const Matrix6d covariance = root * root.transpose();
    const Observability o = observability_of(covariance, 1.0, kWeak_m);
    EXPECT_LT((o.directions.transpose() * o.directions - Matrix6d::Identity()).norm(), 1e-9);
    const Matrix6d again = o.directions * o.sigmas_m.cwiseAbs2().asDiagonal() * o.directions.transpose();
    EXPECT_LT((again - covariance).norm(), 1e-9 * covariance.norm() + 1e-15);
}

TEST(Observability, AnObliqueDirectionIsNamedByItsNumbers) {
    Matrix6d covariance = diagonal(Twist::Constant(0.0001));
    const Eigen::Vector3d slide = Eigen::Vector3d(1.0, 1.0, 0.0).normalized();
    covariance.bottomRightCorner<3, 3>() += slide * slide.transpose();
    EXPECT_EQ(observability_of(covariance, kRadius_m, kWeak_m).weak,
              (std::vector<std::string>{"slides along (0.71 0.71 0.00)"}));
}

TEST(Observability, WhatADeclaredSymmetryLeavesOpenIsNoWeakDirection) {
    Twist sigmas = Twist::Constant(0.0001);
    sigmas[2] = 10.0;  // turns about z, through the centre
    Symmetries shaft;
    shaft.continuous.push_back({Eigen::Vector3d::UnitZ(), Eigen::Vector3d::Zero()});
    EXPECT_EQ(observability_of(diagonal(sigmas), kRadius_m, kWeak_m).weak.size(), 1U);
    EXPECT_TRUE(observability_of(diagonal(sigmas), kRadius_m, kWeak_m, shaft).weak.empty());
    // An axis beside the centre: a turn about it also moves the centre.
    const Eigen::Vector3d beside(0.03, 0.0, 0.0);
    shaft.continuous[0].offset_in_object_m = beside;
    Twist turn;
    turn << Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitZ().cross(-beside);
    const Matrix6d covariance = diagonal(Twist::Constant(0.0001)) + turn * turn.transpose();
    EXPECT_TRUE(observability_of(covariance, kRadius_m, kWeak_m, shaft).weak.empty());
    EXPECT_FALSE(observability_of(covariance, kRadius_m, kWeak_m).weak.empty());
}

}  // namespace
}  // namespace nearpose
