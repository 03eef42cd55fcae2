#include "core/search/sampling.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/core/analytic_part.hpp"

namespace nearpose {
namespace {

const test::BoxViewGenerator kPart(test::asymmetric_part());
const PinholeCamera kCamera = test::small_camera();
const Pose kTruth{Eigen::Quaterniond(Eigen::AngleAxisd(2.6, Eigen::Vector3d(1, 0.3, 0.1).normalized())),
                  {0.05, 0, 0.45}};

Observation observe_part() {
    Mask mask;
    const DepthImage image = test::render(kPart, kTruth, kCamera, 0.8F, &mask);
    return make_observation(image, kCamera, mask);
}

TEST(Sampling, SphereHasTheMeanDistanceAsRadiusAndAllOrientations) {
    const Observation observation = observe_part();
    const ParticleSet particles = sample_on_sphere(observation, kPart.extent(), 2000, 1, 1);
    ASSERT_EQ(particles.size(), 2000);
    Eigen::Matrix3d outer = Eigen::Matrix3d::Zero();
    for (const Pose& pose : particles.poses) {
        // The viewing pose is the inverse: the camera stands on a sphere about the object's centre.
        const Eigen::Vector3d camera_in_object = pose.inverse().translation;
        EXPECT_NEAR((camera_in_object - kPart.extent().centre_in_object()).norm(), observation.mean_distance_m(), 1e-9);
        const Eigen::Vector3d axis = pose.rotation.conjugate() * Eigen::Vector3d::UnitZ();
        outer += axis * axis.transpose() / 2000.0;
    }
    EXPECT_LT((outer - Eigen::Matrix3d::Identity() / 3.0).norm(), 0.05);
}

TEST(Sampling, AroundAPoseKeepsThePoseItself) {
    const ParticleSet particles = sample_around(kTruth, {0.1, 0.01}, kPart.extent(), 500, 1, 1);
    EXPECT_EQ(angle_between(particles.poses[0].rotation, kTruth.rotation), 0.0);
    double sum2 = 0.0;
    for (const Pose& pose : particles.poses) {
        const double angle = angle_between(pose.rotation, kTruth.rotation);
        sum2 += angle * angle / 500.0;
    }
    EXPECT_NEAR(std::sqrt(sum2), 0.1 * std::sqrt(3.0), 0.015);
}

TEST(Sampling, OrientedPointsLieOnTheSurfaceWithOutwardNormalsOnAllSides) {
    const auto points = sample_surface(kPart);
    ASSERT_GT(points.size(), 500U);
    std::array<int, 6> sides{};
    for (const OrientedPoint& oriented : points) {
        // A small step along an outward normal leaves the part.
        const Eigen::Vector3d eye = (oriented.point + 0.001F * oriented.normal).cast<double>();
        bool inside = false;
        for (const test::Box& box : test::asymmetric_part())
            inside |= (eye.array() > box.min.array()).all() && (eye.array() < box.max.array()).all();
        EXPECT_FALSE(inside);
        int axis = 0;
        oriented.normal.cwiseAbs().maxCoeff(&axis);
        ++sides[2 * axis + (oriented.normal[axis] > 0)];
    }
    for (const int side : sides) EXPECT_GT(side, 50);
}

TEST(Sampling, OnSurfaceAlignsAPointWithAMeasuredOneNormalOnNormal) {
    const Observation observation = observe_part();
    const std::vector<OrientedPoint> one = {{{0.1F, 0.02F, 0.01F}, {1, 0, 0}}};
    const ParticleSet particles = sample_on_surface(observation, one, 50, 1, 1, 0);
    ASSERT_EQ(particles.size(), 50);
    for (const Pose& pose : particles.poses) {
        const Eigen::Vector3f point = (pose * one[0].point.cast<double>()).cast<float>();
        const Eigen::Vector3f normal = (pose.rotation * one[0].normal.cast<double>()).cast<float>();
        float best = 1.0F;
        for (std::size_t p = 0; p < observation.points_in_camera().size(); ++p)
            best = std::min(best, (observation.points_in_camera()[p] - point).norm() +
                                      (observation.normals_in_camera()[p] - normal).norm());
        EXPECT_LT(best, 1e-4F);
    }
    EXPECT_EQ(sample_on_surface(observation, {}, 50, 1, 1, 0).size(), 0);
}

TEST(Sampling, ShiftBringsTheSeenSurfaceOntoTheMeasuredOne) {
    const Observation observation = observe_part();
    Pose off = kTruth;
    off.translation += Eigen::Vector3d(0.02, -0.03, 0.06);
    const Pose shifted = shift_to_seen_surface(off, observation, kPart, kCamera);
    EXPECT_LT((shifted.translation - kTruth.translation).norm(), 0.012) << "another pose shows a little other surface";
    Pose away = kTruth;
    away.translation.x() += 10.0;  // out of view: nothing to go by
    EXPECT_EQ(shift_to_seen_surface(away, observation, kPart, kCamera).translation.x(), away.translation.x());
}

}  // namespace
}  // namespace nearpose
