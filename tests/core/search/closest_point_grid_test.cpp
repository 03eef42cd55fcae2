#include "core/search/closest_point_grid.hpp"

#include <gtest/gtest.h>

#include "tests/core/analytic_part.hpp"

namespace nearpose {
namespace {

const test::BoxViewGenerator kPart(test::asymmetric_part());
const PinholeCamera kCamera{64, 48, 60.0, 60.0, 31.5, 23.5};
const Pose kTruth{Eigen::Quaterniond(Eigen::AngleAxisd(2.5, Eigen::Vector3d(1, 0.4, 0.2).normalized())),
                  {0.03, -0.01, 0.35}};

const ClosestPointGrid& grid() {
    static const ClosestPointGrid kGrid(kPart);
    return kGrid;
}

// What a camera measures when the part is at the true pose, in camera coordinates.
std::vector<OrientedPoint> measured() {
    const View view = kPart.generate(kTruth, kCamera);
    std::vector<OrientedPoint> points;
    for (std::size_t k = 0; k < view.size(); ++k)
        points.push_back({(kTruth * view.points_in_object[k].cast<double>()).cast<float>(),
                          kTruth.rotation.cast<float>() * view.normals_in_object[k]});
    return points;
}

constexpr double kTolerance_m = 0.006;

TEST(ClosestPointGrid, NearestIsNearAtTheSurfaceAndNothingFarFromIt) {
    const View view = kPart.generate(kTruth, kCamera);
    ASSERT_GT(view.size(), 100U);
    for (const Eigen::Vector3f& point : view.points_in_object) {
        const OrientedPoint* nearest = grid().nearest(point);
        ASSERT_NE(nearest, nullptr);
        EXPECT_LT((nearest->point - point).norm(), grid().reach_m());
    }
    EXPECT_EQ(grid().nearest(Eigen::Vector3f(0.0F, 0.0F, 1.0F)), nullptr);
    EXPECT_EQ(grid().nearest(Eigen::Vector3f(-10.0F, 0.0F, 0.0F)), nullptr);
    EXPECT_EQ(grid().nearest(Eigen::Vector3f::Zero()), nullptr) << "the middle of the base is solid";
}

TEST(InlierShare, NearlyAllAtTheTruthAndNoneFarAway) {
    const std::vector<OrientedPoint> points = measured();
    EXPECT_GT(inlier_share(grid(), kTruth, points, points.size(), kTolerance_m), 0.9);
    Pose away = kTruth;
    away.translation.z() += 1.0;
    EXPECT_EQ(inlier_share(grid(), away, points, points.size(), kTolerance_m), 0.0);
    EXPECT_EQ(inlier_share(grid(), kTruth, {}, 10, kTolerance_m), 0.0);
}

TEST(AlignToSurface, ComesBackFromANearbyPose) {
    const std::vector<OrientedPoint> points = measured();
    const Eigen::Vector3d centre = kPart.extent().centre_in_object();
    Twist off;
    off << 0.06, -0.05, 0.06, 0.005, -0.004, 0.005;
    const Pose start = perturb_about(kTruth, off, centre);
    const Pose aligned = align_to_surface(grid(), start, points, 4, kTolerance_m);
    EXPECT_LT((aligned * centre - kTruth * centre).norm(), 0.002);
    EXPECT_LT(angle_between(aligned.rotation, kTruth.rotation), 0.02);
}

TEST(AlignToSurface, StaysWhereNothingIsNear) {
    Pose away = kTruth;
    away.translation.z() += 1.0;
    const Pose aligned = align_to_surface(grid(), away, measured(), 4, kTolerance_m);
    EXPECT_LT((aligned.translation - away.translation).norm(), 1e-9);
}

}  // namespace
}  // namespace nearpose
