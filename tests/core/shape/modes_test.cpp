#include "core/shape/modes.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace nearpose {
namespace {

Mode mode(double x, double angle_rad, double cost) {
    return {{Eigen::Quaterniond(Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::UnitZ())), {x, 0, 1}}, cost, 0.0};
}

TEST(Modes, DistinctOnesBestFirst) {
    const std::vector<Mode> modes = {mode(0, 0, 0.5), mode(0.001, 0.01, 0.4), mode(0.1, 0, 0.3), mode(0, M_PI, 0.9),
                                     mode(0.5, 0, std::nan(""))};
    const auto chosen = distinct_modes(modes, 10, Eigen::Vector3d::Zero(), {0.2, 0.02});
    ASSERT_EQ(chosen.size(), 3U);
    EXPECT_EQ(chosen[0].cost, 0.3);
    EXPECT_EQ(chosen[1].cost, 0.4) << "of two that are one, the better";
    EXPECT_EQ(chosen[2].cost, 0.9);
    EXPECT_EQ(distinct_modes(modes, 1, Eigen::Vector3d::Zero(), {0.2, 0.02}).size(), 1U);
    EXPECT_TRUE(distinct_modes({}, 3, Eigen::Vector3d::Zero(), {0.2, 0.02}).empty());
}

TEST(Modes, DistanceIsMeasuredAtTheCentreNotAtTheOrigin) {
    // A turn about a centre that is far from the origin moves the origin, but is the same place.
    const Eigen::Vector3d centre(1.0, 0, 0);
    const Pose a = Pose::identity();
    const Pose b = perturb_about(a, (Twist() << 0, 0, 0.1, 0, 0, 0).finished(), centre);
    EXPECT_GT((a.translation - b.translation).norm(), 0.05);
    EXPECT_TRUE(same_mode(a, b, centre, {0.2, 0.02}));
    EXPECT_FALSE(same_mode(a, b, Eigen::Vector3d::Zero(), {0.2, 0.02}));
}

TEST(Modes, AlternativesTurnAboutTheCentreOrShiftAlongAnAxisAndAreNeverThePoseItself) {
    const ModelExtent extent{{-0.1, 0.0, 0.2}, {0.3, 0.2, 0.5}};
    const Eigen::Vector3d centre = extent.centre_in_object();
    const Pose pose{Eigen::Quaterniond(Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitX())), {0, 0, 1}};
    const auto alternatives = alternatives_of(pose, extent, 200, 1, 1);
    ASSERT_EQ(alternatives.size(), 200U);
    int half_turns = 0, pure_shifts = 0;
    for (const Pose& alternative : alternatives) {
        const double angle = angle_between(pose.rotation, alternative.rotation);
        const double quarters = angle / (M_PI / 2.0);
        EXPECT_NEAR(quarters, std::round(quarters), 1e-9);
        const Eigen::Vector3d shift = pose.inverse() * (alternative * centre) - centre;
        EXPECT_LE((shift.array().abs() > 1e-12).count(), 1) << "along one axis at most";
        for (int axis = 0; axis < 3; ++axis)
            EXPECT_LE(std::abs(shift[axis]), 0.5 * (extent.box_max_in_object - extent.box_min_in_object)[axis] + 1e-12);
        half_turns += angle > 3.0;
        pure_shifts += angle < 0.1;
        EXPECT_TRUE(angle > 0.1 || shift.norm() > 1e-6);
    }
    EXPECT_GT(half_turns, 20);
    EXPECT_GT(pure_shifts, 20);
}

}  // namespace
}  // namespace nearpose
