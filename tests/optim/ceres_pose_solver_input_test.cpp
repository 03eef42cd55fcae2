// What the Ceres solver does with numbers that are not usable: the pose stays, and nothing is printed.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>

#include "optim/ceres_pose_solver.hpp"
#include "tests/optim/pairs_of_shapes.hpp"

namespace nearpose {
namespace {

using testing_shapes::ellipsoid_pairs;
using testing_shapes::exact_pose;
using testing_shapes::make_twist;

const Pose kStart = exact_pose() * exp(make_twist(0.05, -0.03, 0.02, 0.004, -0.003, 0.005));

void expect_unchanged(const CeresSolverOptions& options, const Correspondences& pairs, const Pose& start,
                      SolveStatus status) {
    testing::internal::CaptureStderr();
    testing::internal::CaptureStdout();
    const SolveResult result = CeresPoseSolver(options).solve(pairs, start);
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
    EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
    EXPECT_EQ(result.status, status);
    EXPECT_EQ(std::memcmp(&result.camera_from_object.rotation, &start.rotation, sizeof start.rotation), 0);
    EXPECT_EQ(std::memcmp(&result.camera_from_object.translation, &start.translation, sizeof start.translation), 0);
}

TEST(CeresPoseSolverInput, TooFewPairsLeaveThePose) {
    CeresSolverOptions options;
    expect_unchanged(options, {}, kStart, SolveStatus::kTooFewPairs);
    expect_unchanged(options, ellipsoid_pairs(5, exact_pose()), kStart, SolveStatus::kTooFewPairs);
    EXPECT_EQ(CeresPoseSolver(options).solve(ellipsoid_pairs(6, exact_pose()), kStart).status, SolveStatus::kConverged);
    options.min_pairs = 50;
    expect_unchanged(options, ellipsoid_pairs(49, exact_pose()), kStart, SolveStatus::kTooFewPairs);
}

TEST(CeresPoseSolverInput, NumbersThatAreNotUsableLeaveThePose) {
    using Spoil = std::function<void(Correspondences&, float)>;
    const Spoil spoils[] = {[](Correspondences& pairs, float value) { pairs.points_in_object[4].x() = value; },
                            [](Correspondences& pairs, float value) { pairs.points_in_camera[5].z() = value; },
                            [](Correspondences& pairs, float value) { pairs.normals_in_object[0].y() = value; },
                            [](Correspondences& pairs, float value) { pairs.sigmas_m[9] = value; }};
    const float infinity = std::numeric_limits<float>::infinity();
    for (const Spoil& spoil : spoils) {
        for (const float value : {std::numeric_limits<float>::quiet_NaN(), infinity, -infinity}) {
            Correspondences pairs = ellipsoid_pairs(10, exact_pose());
            spoil(pairs, value);
            expect_unchanged({}, pairs, kStart, SolveStatus::kNotUsable);
        }
    }
    for (const float sigma_m : {0.0f, -0.001f}) {
        Correspondences pairs = ellipsoid_pairs(10, exact_pose());
        pairs.sigmas_m[9] = sigma_m;
        expect_unchanged({}, pairs, kStart, SolveStatus::kNotUsable);
    }
}

TEST(CeresPoseSolverInput, APoseThatIsNotOneIsNotConverged) {
    const Correspondences pairs = ellipsoid_pairs(20, exact_pose());
    Pose far_away = exact_pose();
    far_away.translation.z() = 1e200;  // the squared residual overflows, which Ceres alone calls converged
    expect_unchanged({}, pairs, far_away, SolveStatus::kNotUsable);
    Pose not_finite = exact_pose();
    not_finite.rotation.x() = std::nan("");
    expect_unchanged({}, pairs, not_finite, SolveStatus::kNotUsable);
}

TEST(CeresPoseSolverInput, ExtremeButFiniteNumbersEndInAFiniteResult) {
    Correspondences pairs = ellipsoid_pairs(20, exact_pose());
    pairs.points_in_camera[3].x() = 3e38f;
    for (const float sigma_m : {1e-45f, 1e-3f, 3e38f}) {
        pairs.sigmas_m[7] = sigma_m;
        testing::internal::CaptureStderr();
        const SolveResult result = CeresPoseSolver().solve(pairs, kStart);
        EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
        EXPECT_TRUE(is_valid(result.camera_from_object));
        EXPECT_TRUE(std::isfinite(result.final_cost));
        EXPECT_LE(result.final_cost, result.initial_cost);
    }
}

TEST(CeresSolverOptions, ValidateNamesTheField) {
    const auto refuses = [](const char* field, const std::function<void(CeresSolverOptions&)>& change) {
        CeresSolverOptions options;
        change(options);
        try {
            validate(options);
            ADD_FAILURE() << field << " was accepted";
        } catch (const std::invalid_argument& error) {
            EXPECT_NE(std::string(error.what()).find(field), std::string::npos) << error.what();
        }
        EXPECT_THROW(CeresPoseSolver{options}, std::invalid_argument);
    };
    EXPECT_NO_THROW(validate(CeresSolverOptions{}));
    refuses("loss_scale_sigmas", [](CeresSolverOptions& options) { options.loss_scale_sigmas = 0.0; });
    refuses("loss_scale_sigmas", [](CeresSolverOptions& options) { options.loss_scale_sigmas = std::nan(""); });
    refuses("max_iterations", [](CeresSolverOptions& options) { options.max_iterations = 0; });
    refuses("min_pairs", [](CeresSolverOptions& options) { options.min_pairs = 5; });
    refuses("function_tolerance", [](CeresSolverOptions& options) { options.function_tolerance = -1.0; });
    refuses("damping", [](CeresSolverOptions& options) { options.damping = 0.0; });
    CeresSolverOptions three;
    three.residual = ResidualKind::kPointToPoint;
    three.min_pairs = 3;
    EXPECT_NO_THROW(validate(three));
}

}  // namespace
}  // namespace nearpose
