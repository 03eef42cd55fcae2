#include "optim/internal/se3_manifold.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "pairs_of_shapes.hpp"

namespace nearpose {
namespace {

using Ambient = Se3Manifold::Ambient;

const double kAngles[] = {0.0, 1e-12, 1e-8, 1e-4, 0.5, 2.0, M_PI - 1e-6};

Twist random_twist(std::mt19937& random, double angle_rad) {
    Twist twist;
    twist << angle_rad * testing_shapes::random_vector(random).normalized(), testing_shapes::random_vector(random);
    return twist;
}

std::vector<Ambient> places() {
    std::mt19937 random(5);
    std::vector<Ambient> result;
    for (const double angle : kAngles)
        result.push_back(Se3Manifold::ambient_from_pose(exp(random_twist(random, angle))));
    result.push_back(-result.back());  // both quaternions of a rotation
    result.back().tail<3>() *= -1.0;
    return result;
}

TEST(Se3Manifold, SizesAndOrder) {
    const Se3Manifold manifold;
    EXPECT_EQ(manifold.AmbientSize(), 7);
    EXPECT_EQ(manifold.TangentSize(), 6);
    const Pose quarter_turn{Eigen::Quaterniond(std::sqrt(0.5), 0.0, 0.0, std::sqrt(0.5)), {1.0, 2.0, 3.0}};
    Ambient expected;
    expected << 0.0, 0.0, std::sqrt(0.5), std::sqrt(0.5), 1.0, 2.0, 3.0;
    EXPECT_EQ(Se3Manifold::ambient_from_pose(quarter_turn), expected);
    EXPECT_EQ(Se3Manifold::pose_from_ambient(expected.data()).rotation.w(), std::sqrt(0.5));
}

TEST(Se3Manifold, PlusIsTheRightPerturbationOfThePose) {
    std::mt19937 random(6);
    const Se3Manifold manifold;
    for (const Ambient& x : places()) {
        const Twist delta = random_twist(random, 0.7);
        Ambient moved;
        ASSERT_TRUE(manifold.Plus(x.data(), delta.data(), moved.data()));
        const Pose expected = Se3Manifold::pose_from_ambient(x.data()) * exp(delta);
        EXPECT_LT((moved - Se3Manifold::ambient_from_pose(expected)).norm(), 1e-15);
        EXPECT_NEAR(moved.head<4>().norm(), 1.0, 1e-15);
    }
}

TEST(Se3Manifold, PlusOfZeroStays) {
    const Se3Manifold manifold;
    const Twist zero = Twist::Zero();
    for (const Ambient& x : places()) {
        Ambient moved;
        ASSERT_TRUE(manifold.Plus(x.data(), zero.data(), moved.data()));
        EXPECT_LT((moved - x).norm(), 1e-15);
    }
}

TEST(Se3Manifold, MinusUndoesPlus) {
    std::mt19937 random(7);
    const Se3Manifold manifold;
    for (const Ambient& x : places()) {
        for (const double angle : kAngles) {
            const Twist delta = random_twist(random, angle);
            Ambient moved;
            Twist back;
            ASSERT_TRUE(manifold.Plus(x.data(), delta.data(), moved.data()));
            ASSERT_TRUE(manifold.Minus(moved.data(), x.data(), back.data()));
            EXPECT_LT((back - delta).norm(), 1e-8) << angle;
        }
    }
}

TEST(Se3Manifold, JacobiansAreTheDerivatives) {
    const Se3Manifold manifold;
    constexpr double kStep = 1e-5;
    for (const Ambient& x : places()) {
        Se3Manifold::AmbientFromTangent plus, numeric_plus;
        Se3Manifold::TangentFromAmbient minus, numeric_minus;
        ASSERT_TRUE(manifold.PlusJacobian(x.data(), plus.data()));
        ASSERT_TRUE(manifold.MinusJacobian(x.data(), minus.data()));
        for (int k = 0; k < 6; ++k) {
            const Twist forth = kStep * Twist::Unit(k), back = -forth;
            Ambient a, b;
            manifold.Plus(x.data(), forth.data(), a.data());
            manifold.Plus(x.data(), back.data(), b.data());
            numeric_plus.col(k) = (a - b) / (2.0 * kStep);
        }
        for (int k = 0; k < 7; ++k) {
            const Ambient forth = x + kStep * Ambient::Unit(k), back = x - kStep * Ambient::Unit(k);
            Twist a, b;
            manifold.Minus(forth.data(), x.data(), a.data());
            manifold.Minus(back.data(), x.data(), b.data());
            numeric_minus.col(k) = (a - b) / (2.0 * kStep);
        }
        EXPECT_LT((plus - numeric_plus).norm(), 1e-9);
        EXPECT_LT((minus - numeric_minus).norm(), 1e-9);
        EXPECT_LT((minus * plus - Matrix6d::Identity()).norm(), 1e-14);
    }
}

TEST(Se3Manifold, RefusesWhatIsNotFinite) {
    const Se3Manifold manifold;
    const Ambient x = places().front();
    const Twist delta = Twist::Constant(std::nan(""));
    Ambient moved;
    EXPECT_FALSE(manifold.Plus(x.data(), delta.data(), moved.data()));
}

}  // namespace
}  // namespace nearpose
