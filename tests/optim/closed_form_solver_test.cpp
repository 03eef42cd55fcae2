#include "optim/closed_form_solver.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "optim/ceres_pose_solver.hpp"
#include "tests/optim/pairs_of_shapes.hpp"

namespace nearpose {
namespace {

using testing_shapes::ellipsoid_pairs;
using testing_shapes::exact_pose;
using testing_shapes::make_twist;
using testing_shapes::rotation_error;
using testing_shapes::translation_error;

const Pose kFarStart = exact_pose() * exp(make_twist(2.0, -1.0, 1.5, 0.1, 0.2, -0.3));

TEST(ClosedFormPoseSolver, RecoversAKnownPoseFromAnywhere) {
    const SolveResult result = ClosedFormPoseSolver().solve(ellipsoid_pairs(100, exact_pose()), kFarStart);
    ASSERT_EQ(result.status, SolveStatus::kConverged);
    EXPECT_LT(rotation_error(result.camera_from_object, exact_pose()), 1e-12);
    EXPECT_LT(translation_error(result.camera_from_object, exact_pose()), 1e-12);
    EXPECT_LT(result.final_cost, 1e-15);
    EXPECT_GT(result.initial_cost, 1.0);
}

TEST(ClosedFormPoseSolver, CeresWithoutLossFindsTheSame) {
    CeresSolverOptions options;
    options.residual = ResidualKind::kPointToPoint;
    options.loss = RobustLoss::kNone;
    options.max_iterations = 50;
    options.function_tolerance = 0.0;
    const Pose start = exact_pose() * exp(make_twist(0.2, -0.1, 0.15, 0.02, 0.01, -0.03));
    for (const int count : {4, 9, 200}) {
        const Correspondences pairs = ellipsoid_pairs(count, exact_pose(), 2.0);
        options.min_pairs = 4;
        const SolveResult closed = ClosedFormPoseSolver().solve(pairs, start);
        const SolveResult iterated = CeresPoseSolver(options).solve(pairs, start);
        ASSERT_EQ(closed.status, SolveStatus::kConverged);
        ASSERT_EQ(iterated.status, SolveStatus::kConverged);
        EXPECT_LT(rotation_error(closed.camera_from_object, iterated.camera_from_object), 1e-9) << count;
        EXPECT_LT(translation_error(closed.camera_from_object, iterated.camera_from_object), 1e-9) << count;
        EXPECT_NEAR(closed.initial_cost, iterated.initial_cost, 1e-9 * closed.initial_cost);
        EXPECT_NEAR(closed.final_cost, iterated.final_cost, 1e-9 * closed.final_cost);
        EXPECT_GT(closed.final_cost, 0.0);
    }
}

TEST(ClosedFormPoseSolver, NeverReturnsAReflection) {
    // All points in a plane: without the check of the determinant either side would fit.
    Correspondences pairs = testing_shapes::plane_pairs({0.0, 0.0, 1.0}, exact_pose());
    const SolveResult result = ClosedFormPoseSolver().solve(pairs, kFarStart);
    ASSERT_EQ(result.status, SolveStatus::kConverged);
    EXPECT_LT(rotation_error(result.camera_from_object, exact_pose()), 1e-6);
    EXPECT_NEAR(result.camera_from_object.rotation_matrix().determinant(), 1.0, 1e-12);
}

TEST(ClosedFormPoseSolver, DoesNotLeaveAPoseThatIsTheMinimum) {
    const Correspondences pairs = ellipsoid_pairs(100, exact_pose(), 1.0);
    const Pose best = ClosedFormPoseSolver().solve(pairs, kFarStart).camera_from_object;
    const SolveResult again = ClosedFormPoseSolver().solve(pairs, best);
    EXPECT_EQ(again.status, SolveStatus::kConverged);
    EXPECT_LE(again.final_cost, again.initial_cost);
    EXPECT_LT(translation_error(again.camera_from_object, best), 1e-12);
}

void expect_unchanged(const Correspondences& pairs, SolveStatus status) {
    const SolveResult result = ClosedFormPoseSolver().solve(pairs, kFarStart);
    EXPECT_EQ(result.status, status);
    EXPECT_EQ(result.camera_from_object.rotation.coeffs(), kFarStart.rotation.coeffs());
    EXPECT_EQ(result.camera_from_object.translation, kFarStart.translation);
}

TEST(ClosedFormPoseSolver, DataThatLeaveThePoseUnchanged) {
    expect_unchanged({}, SolveStatus::kTooFewPairs);
    expect_unchanged(ellipsoid_pairs(2, exact_pose()), SolveStatus::kTooFewPairs);
    Correspondences line;
    for (int k = 0; k < 10; ++k) {
        const Eigen::Vector3d point = 0.0078125 * k * Eigen::Vector3d(1.0, 2.0, -1.0);
        testing_shapes::add_pair(line, point, {0.0, 0.0, 1.0}, point, 0.001);
    }
    expect_unchanged(line, SolveStatus::kNotUsable);
    Correspondences not_finite = ellipsoid_pairs(20, exact_pose());
    not_finite.points_in_camera[3].y() = std::numeric_limits<float>::quiet_NaN();
    expect_unchanged(not_finite, SolveStatus::kNotUsable);
}

}  // namespace
}  // namespace nearpose
