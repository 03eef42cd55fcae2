#include "optim/ceres_pose_solver.hpp"

#include <gtest/gtest.h>

#include <thread>
#include <vector>

#include "tests/optim/pairs_of_shapes.hpp"

namespace nearpose {
namespace {

using testing_shapes::ellipsoid_pairs;
using testing_shapes::exact_pose;
using testing_shapes::make_twist;
using testing_shapes::plane_pairs;
using testing_shapes::rotation_error;
using testing_shapes::translation_error;

const Pose kStart = exact_pose() * exp(make_twist(0.05, -0.03, 0.02, 0.004, -0.003, 0.005));

CeresSolverOptions patient(ResidualKind residual, RobustLoss loss, double loss_scale_sigmas = 2.0) {
    CeresSolverOptions options;
    options.residual = residual;
    options.loss = loss;
    options.loss_scale_sigmas = loss_scale_sigmas;
    options.max_iterations = 60;
    options.function_tolerance = 0.0;
    return options;
}

TEST(CeresPoseSolver, RecoversAKnownPose) {
    const Correspondences pairs = ellipsoid_pairs(300, exact_pose());
    for (const ResidualKind residual : {ResidualKind::kPointToPoint, ResidualKind::kPointToPlane}) {
        for (const RobustLoss loss : {RobustLoss::kNone, RobustLoss::kHuber, RobustLoss::kCauchy}) {
            const SolveResult result = CeresPoseSolver(patient(residual, loss)).solve(pairs, kStart);
            ASSERT_EQ(result.status, SolveStatus::kConverged);
            EXPECT_LT(rotation_error(result.camera_from_object, exact_pose()), 1e-9);
            EXPECT_LT(translation_error(result.camera_from_object, exact_pose()), 1e-9);
            EXPECT_LT(result.final_cost, 1e-9);
            EXPECT_GT(result.initial_cost, 100.0);
            EXPECT_NEAR(result.camera_from_object.rotation.norm(), 1.0, 1e-15);
        }
    }
}

TEST(CeresPoseSolver, DefaultsComeCloseInTheirFewIterations) {
    const SolveResult result = CeresPoseSolver().solve(ellipsoid_pairs(300, exact_pose()), kStart);
    EXPECT_LT(rotation_error(result.camera_from_object, exact_pose()), 1e-3);
    EXPECT_LT(translation_error(result.camera_from_object, exact_pose()), 1e-4);
}

// Three in ten measured points stand 20 to 60 mm in front of the surface.
Correspondences with_outliers() {
    Correspondences pairs = ellipsoid_pairs(300, exact_pose());
    for (std::size_t k = 0; k < pairs.size(); k += 10) {
        for (const std::size_t j : {k, k + 3, k + 7}) {
            const Eigen::Vector3d normal = exact_pose().rotation * pairs.normals_in_object[j].cast<double>();
            const double distance_m = 0.02 + 0.04 * static_cast<double>(j) / 300.0;
            pairs.points_in_camera[j] += (distance_m * normal).cast<float>();
        }
    }
    return pairs;
}

TEST(CeresPoseSolver, OutliersHaveNoPullUnderABoundedLossAndLittleUnderCauchy) {
    const Correspondences pairs = with_outliers();
    for (const ResidualKind residual : {ResidualKind::kPointToPoint, ResidualKind::kPointToPlane}) {
        const auto solve = [&](RobustLoss loss, double scale) {
            return CeresPoseSolver(patient(residual, loss, scale)).solve(pairs, kStart).camera_from_object;
        };
        const Pose tukey = solve(RobustLoss::kTukey, 8.0);
        EXPECT_LT(rotation_error(tukey, exact_pose()), 1e-8);
        EXPECT_LT(translation_error(tukey, exact_pose()), 1e-9);
        const Pose cauchy = solve(RobustLoss::kCauchy, 2.0);
        const Pose plain = solve(RobustLoss::kNone, 2.0);
        EXPECT_LT(rotation_error(cauchy, exact_pose()), 5e-3);
        EXPECT_LT(translation_error(cauchy, exact_pose()), 2e-4);
        EXPECT_GT(translation_error(plain, exact_pose()), 5.0 * translation_error(cauchy, exact_pose()));
    }
}

TEST(CeresPoseSolver, CostIsHalfTheSumOfTheLoss) {
    // One sigma along the normal for every pair: half of rho(1) each.
    Correspondences pairs = plane_pairs({0.0, 0.0, 1.0}, Pose::identity());
    for (Eigen::Vector3f& point : pairs.points_in_camera) point.z() += 0.001f;
    CeresSolverOptions options = patient(ResidualKind::kPointToPlane, RobustLoss::kCauchy, 3.0);
    const SolveResult result = CeresPoseSolver(options).solve(pairs, Pose::identity());
    const auto n = static_cast<double>(pairs.size());
    EXPECT_NEAR(result.initial_cost, 0.5 * n * 9.0 * std::log1p(1.0 / 9.0), 1e-4 * n);
    EXPECT_LT(result.final_cost, 1e-6);
}

TEST(CeresPoseSolver, APlaneMovesAlongItsNormalOnly) {
    // The second is tilted by a hundredth against an axis, the third by the rounding of a float.
    for (const Eigen::Vector3d& normal :
         {Eigen::Vector3d(0.3, -0.2, 0.9), Eigen::Vector3d(0.01, 0.0, 1.0), Eigen::Vector3d(1e-7, 0.0, 1.0)}) {
        const Eigen::Vector3d unit = normal.normalized();
        const Correspondences pairs = plane_pairs(normal, exact_pose());
        Twist shift = Twist::Zero();
        shift.tail<3>() = 0.005 * unit + 0.003 * unit.unitOrthogonal();
        const Pose start = exact_pose() * exp(shift);
        const SolveResult result =
            CeresPoseSolver(patient(ResidualKind::kPointToPlane, RobustLoss::kHuber)).solve(pairs, start);
        ASSERT_EQ(result.status, SolveStatus::kConverged);
        const Twist left = log(exact_pose().inverse() * result.camera_from_object);
        EXPECT_NEAR(left.tail<3>().dot(unit), 0.0, 1e-7);
        const Twist moved = log(start.inverse() * result.camera_from_object);
        EXPECT_LT(moved.head<3>().norm(), 1e-6);
        EXPECT_LT((moved.tail<3>() - moved.tail<3>().dot(unit) * unit).norm(), 1e-6);
        EXPECT_NEAR(moved.tail<3>().dot(unit), -0.005, 1e-6);
    }
}

TEST(CeresPoseSolver, NoiseDoesNotDriveAnAlmostPlaneAlongItself) {
    // A normal's error of a milliradian makes the free directions observable in name only: without damping, the noise
    // would move the plane by centimetres.
    std::mt19937 random(3);
    Correspondences pairs = plane_pairs({0.3, -0.2, 0.9}, exact_pose());
    for (std::size_t k = 0; k < pairs.size(); ++k) {
        const Eigen::Vector3d normal =
            pairs.normals_in_object[k].cast<double>() + 0.001 * testing_shapes::random_vector(random);
        pairs.normals_in_object[k] = normal.normalized().cast<float>();
        pairs.points_in_camera[k] += (0.001 * testing_shapes::random_vector(random)).cast<float>();
    }
    const SolveResult result = CeresPoseSolver().solve(pairs, exact_pose());
    ASSERT_EQ(result.status, SolveStatus::kConverged);
    EXPECT_LT(translation_error(result.camera_from_object, exact_pose()), 0.002);
    EXPECT_LT(rotation_error(result.camera_from_object, exact_pose()), 0.01);
}

TEST(CeresPoseSolver, ASphereFindsItsCentreAndHardlyTurns) {
    const Eigen::Vector3d centre(0.02, -0.01, 0.03);
    for (const double lowest : {-1.0, 0.5}) {  // the whole sphere, a cap
        std::mt19937 random(4);
        Correspondences pairs;
        while (pairs.size() < 200) {
            const Eigen::Vector3d normal = testing_shapes::random_vector(random).normalized();
            if (normal.z() < lowest) continue;
            const Eigen::Vector3d point = centre + 0.05 * normal;
            testing_shapes::add_pair(pairs, point, normal, exact_pose() * point, 0.001);
        }
        const Pose start = exact_pose() * exp(make_twist(0.0, 0.0, 0.0, 0.003, 0.002, -0.002));
        const SolveResult result =
            CeresPoseSolver(patient(ResidualKind::kPointToPlane, RobustLoss::kHuber)).solve(pairs, start);
        ASSERT_EQ(result.status, SolveStatus::kConverged);
        EXPECT_LT((result.camera_from_object * centre - exact_pose() * centre).norm(), 1e-5) << lowest;
        EXPECT_LT(rotation_error(result.camera_from_object, start), 0.1) << lowest;
        EXPECT_LT(result.final_cost, 1e-4);  // the points are rounded to float
    }
}

TEST(CeresPoseSolver, PointsOnALineDoNotBlowUp) {
    Correspondences pairs;
    for (int k = 0; k < 20; ++k) {
        const Eigen::Vector3d point(0.005 * k, 0.0, 0.0);
        testing_shapes::add_pair(pairs, point, {0.0, 0.0, 1.0}, exact_pose() * point, 0.001);
    }
    const CeresSolverOptions options = patient(ResidualKind::kPointToPoint, RobustLoss::kNone);
    const SolveResult result = CeresPoseSolver(options).solve(pairs, kStart);
    EXPECT_LT(result.final_cost, 1e-6);
    EXPECT_LT(rotation_error(result.camera_from_object, kStart), 0.1);
    EXPECT_LT(translation_error(result.camera_from_object, exact_pose()), 1e-6);
}

TEST(CeresPoseSolver, AFarOriginOfTheObjectChangesNothing) {
    // On the grid, so that the floats of the shifted points are exact.
    const double far_m = testing_shapes::kGrid_m * 232000.0;  // about 6.6 m along an axis, 10 m away
    const Eigen::Vector3d origin(far_m, -far_m, 0.5 * far_m);
    Pose near_from_far;
    near_from_far.translation = -origin;
    for (const ResidualKind residual : {ResidualKind::kPointToPoint, ResidualKind::kPointToPlane}) {
        const CeresPoseSolver solver(patient(residual, RobustLoss::kHuber));
        Correspondences near_pairs = ellipsoid_pairs(200, exact_pose(), 1.0);
        Correspondences far_pairs = near_pairs;
        for (Eigen::Vector3f& point : far_pairs.points_in_object) point += origin.cast<float>();
        const SolveResult near = solver.solve(near_pairs, kStart);
        const SolveResult far = solver.solve(far_pairs, kStart * near_from_far);
        ASSERT_EQ(far.status, SolveStatus::kConverged);
        const Pose far_as_near = far.camera_from_object * near_from_far.inverse();
        EXPECT_LT(translation_error(far_as_near, near.camera_from_object), 1e-6);
        EXPECT_LT(rotation_error(far_as_near, near.camera_from_object), 1e-6);
        EXPECT_GT(translation_error(far_as_near, kStart), 1e-3);
    }
}

TEST(CeresPoseSolver, SeveralThreadsGetTheSameBits) {
    const CeresPoseSolver solver;
    const Correspondences pairs = ellipsoid_pairs(301, exact_pose(), 1.0);
    const auto solve_all = [&] {
        std::vector<SolveResult> results;
        for (int k = 0; k < 20; ++k) {
            results.push_back(solver.solve(pairs, kStart * exp(make_twist(0.002 * k, 0.0, 0.0, 0.0, 1e-4 * k, 0.0))));
        }
        return results;
    };
    const std::vector<SolveResult> serial = solve_all();
    std::vector<std::vector<SolveResult>> parallel(3);
    std::vector<std::thread> threads;
    for (auto& results : parallel) threads.emplace_back([&results, &solve_all] { results = solve_all(); });
    for (std::thread& thread : threads) thread.join();
    for (const auto& results : parallel) {
        for (std::size_t k = 0; k < serial.size(); ++k) {
            EXPECT_EQ(results[k].camera_from_object.rotation.coeffs(), serial[k].camera_from_object.rotation.coeffs());
            EXPECT_EQ(results[k].camera_from_object.translation, serial[k].camera_from_object.translation);
            EXPECT_EQ(results[k].final_cost, serial[k].final_cost);
        }
    }
}

}  // namespace
}  // namespace nearpose
