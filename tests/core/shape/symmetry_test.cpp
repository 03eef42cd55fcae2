#include "core/shape/symmetry.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/base/random.hpp"

namespace nearpose {
namespace {

const Eigen::Vector3d kCentre(0.02, -0.01, 0.03);

Pose random_pose(std::uint64_t index) {
    RandomStream random(7, 0, index, RandomPurpose::kStart);
    const Eigen::Quaterniond rotation = random.rotation();
    return {rotation, 0.5 * random.direction()};
}

Symmetries hexagonal_prism() {
    const Pose sixth = turn_about({Eigen::Vector3d::UnitZ(), kCentre}, M_PI / 3.0);
    const Pose flip = turn_about({Eigen::Vector3d::UnitX(), kCentre}, M_PI);
    return {closed_under_products({sixth, flip}, 64), {}, {}};
}

Symmetries cylinder() {
    return {{turn_about({Eigen::Vector3d::UnitX(), kCentre}, M_PI)}, {{Eigen::Vector3d::UnitZ(), kCentre}}, {}};
}

Symmetries ball() {
    return {{}, {{Eigen::Vector3d::UnitZ(), kCentre}, {Eigen::Vector3d::UnitX(), kCentre}}, {}};
}

TEST(Symmetry, ProductsCloseToGroups) {
    const AxisOfRevolution x{Eigen::Vector3d::UnitX(), kCentre}, y{Eigen::Vector3d::UnitY(), kCentre};
    const AxisOfRevolution z{Eigen::Vector3d::UnitZ(), kCentre};
    EXPECT_EQ(closed_under_products({turn_about(x, M_PI / 2), turn_about(y, M_PI / 2)}, 64).size(), 23U);
    EXPECT_EQ(closed_under_products({turn_about(x, M_PI), turn_about(y, M_PI)}, 64).size(), 3U);
    EXPECT_EQ(closed_under_products({turn_about(z, M_PI / 3), turn_about(x, M_PI)}, 64).size(), 11U);
    EXPECT_TRUE(closed_under_products({}, 64).empty());
    EXPECT_EQ(closed_under_products({turn_about(z, 0.2)}, 10).size(), 10U) << "no more than asked for";

    const Symmetries group = hexagonal_prism();
    for (const Pose& a : group.discrete) {
        EXPECT_LT((a * kCentre - kCentre).norm(), 1e-12);
        EXPECT_TRUE(contains(group, a.inverse()));
        for (const Pose& b : group.discrete) EXPECT_TRUE(contains(group, a * b));
    }
}

TEST(Symmetry, ContainsProductsWithTurnsAboutAnAxis) {
    const AxisOfRevolution across{Eigen::Vector3d(0.6, 0.8, 0), kCentre};
    EXPECT_TRUE(contains(cylinder(), Pose::identity()));
    EXPECT_TRUE(contains(cylinder(), turn_about({Eigen::Vector3d::UnitZ(), kCentre}, 1.234)));
    EXPECT_TRUE(contains(cylinder(), turn_about(across, M_PI)));
    EXPECT_FALSE(contains(cylinder(), turn_about(across, 1.0)));
    EXPECT_TRUE(contains(ball(), turn_about(across, 1.0)));
    EXPECT_FALSE(contains({}, turn_about(across, 1.0)));
}

TEST(Symmetry, NearestEquivalentIsEquivalentNeverFartherAndItsOwnAnswer) {
    for (const Symmetries& symmetries : {Symmetries{}, hexagonal_prism(), cylinder(), ball()}) {
        for (std::uint64_t i = 0; i < 50; ++i) {
            const Pose pose = random_pose(2 * i), reference = random_pose(2 * i + 1);
            const Pose nearest = nearest_equivalent(pose, reference, symmetries, kCentre);
            EXPECT_TRUE(contains(symmetries, pose.inverse() * nearest));
            EXPECT_LT((nearest * kCentre - pose * kCentre).norm(), 1e-9) << "the axes pass through the centre";
            const double angle = angle_between(nearest.rotation, reference.rotation);
            EXPECT_LE(angle, angle_between(pose.rotation, reference.rotation) + 1e-9);
            const Pose again = nearest_equivalent(nearest, reference, symmetries, kCentre);
            EXPECT_LT(angle_between(again.rotation, nearest.rotation), 1e-9);
            for (const Pose& symmetry : symmetries.discrete)
                EXPECT_LE(angle, angle_between((pose * symmetry).rotation, reference.rotation) + 1e-9);
        }
    }
}

TEST(Symmetry, NearestEquivalentOfAnEqualPoseIsTheReference) {
    for (const Symmetries& symmetries : {hexagonal_prism(), cylinder(), ball()}) {
        const Pose reference = random_pose(1);
        Pose equal = reference;
        if (!symmetries.discrete.empty()) equal = equal * symmetries.discrete.back();
        for (const AxisOfRevolution& axis : symmetries.continuous) equal = equal * turn_about(axis, 2.2);
        const Pose nearest = nearest_equivalent(equal, reference, symmetries, kCentre);
        EXPECT_LT(angle_between(nearest.rotation, reference.rotation), 1e-7);
        EXPECT_LT((nearest.translation - reference.translation).norm(), 1e-7);
    }
}

TEST(Symmetry, TheClosedFormOfAnAxisBeatsASearchOverItsTurns) {
    const Symmetries symmetries = cylinder();
    const Pose pose = random_pose(4), reference = random_pose(5);
    const Pose nearest = nearest_equivalent(pose, reference, symmetries, kCentre);
    const double angle = angle_between(nearest.rotation, reference.rotation);
    for (int i = 0; i < 720; ++i) {
        const Pose turned = pose * turn_about(symmetries.continuous[0], i * M_PI / 360.0);
        EXPECT_LE(angle, angle_between(turned.rotation, reference.rotation) + 1e-9);
    }
}

}  // namespace
}  // namespace nearpose
