#include "optim/internal/registration_cost.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <tuple>

#include "tests/optim/pairs_of_shapes.hpp"

namespace nearpose {
namespace {

using testing_shapes::ellipsoid_pairs;
using testing_shapes::exact_pose;
using testing_shapes::make_twist;

double rho(RobustLoss loss, double a, double s) {
    const double b = a * a;
    if (loss == RobustLoss::kHuber) return s <= b ? s : 2.0 * a * std::sqrt(s) - b;
    if (loss == RobustLoss::kCauchy) return b * std::log1p(s / b);
    if (loss == RobustLoss::kTukey) return s <= b ? s - s * s / b + s * s * s / (3.0 * b * b) : b / 3.0;
    return s;
}

// The rows as they are defined, in metres and in the camera's frame.
Eigen::VectorXd reference_rows(const Correspondences& pairs, const Pose& pose, ResidualKind kind, RobustLoss loss,
                               double a) {
    const int rows = kind == ResidualKind::kPointToPoint ? 3 : 1;
    Eigen::VectorXd result(rows * static_cast<Eigen::Index>(pairs.size()));
    for (std::size_t k = 0; k < pairs.size(); ++k) {
        const Eigen::Vector3d difference =
            (pose * pairs.points_in_object[k].cast<double>() - pairs.points_in_camera[k].cast<double>()) /
            pairs.sigmas_m[k];
        Eigen::VectorXd e = difference;
        if (rows == 1) e = (pose.rotation * pairs.normals_in_object[k].cast<double>()).transpose() * difference;
        const double s = e.squaredNorm();
        result.segment(rows * static_cast<Eigen::Index>(k), rows) = s > 0.0 ? e * std::sqrt(rho(loss, a, s) / s) : e;
    }
    return result;
}

class RegistrationCostOf : public testing::TestWithParam<std::tuple<ResidualKind, RobustLoss>> {
  protected:
    ResidualKind kind = std::get<0>(GetParam());
    RobustLoss loss = std::get<1>(GetParam());
    double scale = 2.0;

    // Against rows that are differentiated numerically by the parameters, at the start and away from it.
    void expect_equal_to_rows(const Correspondences& correspondences, const Pose& pose) const {
        for (const Twist& away : {Twist(Twist::Zero()), make_twist(0.4, -0.2, 0.3, 0.1, 0.2, -0.1)})
            expect_equal_to_rows_at(away, correspondences, pose);
    }

    void expect_equal_to_rows_at(const Twist& x, const Correspondences& correspondences, const Pose& pose) const {
        const NormalisedPairs pairs(correspondences, kind);
        ASSERT_TRUE(pairs.usable);
        RegistrationCost cost(pairs, {kind, loss, scale}, pairs.normalised(pose));
        const double stay = 0.25 * pairs.total_squared_weight;
        cost.set_stay(stay);
        const auto rows = [&](const Twist& parameters) {
            return reference_rows(correspondences, pairs.metric(cost.pose_at(parameters.data())), kind, loss, scale);
        };
        const Eigen::VectorXd r = rows(x);
        Eigen::MatrixXd jacobian(r.size(), 6);
        constexpr double kStep = 1e-6;
        for (int k = 0; k < 6; ++k) {
            jacobian.col(k) = (rows(x + kStep * Twist::Unit(k)) - rows(x - kStep * Twist::Unit(k))) / (2.0 * kStep);
        }

        Eigen::Matrix<double, 13, 1> residuals, residuals_only;
        Eigen::Matrix<double, 13, 6> tangent;
        ASSERT_TRUE(cost(x.data(), residuals_only.data(), nullptr));
        ASSERT_TRUE(cost(x.data(), residuals.data(), tangent.data()));

        const double squares = r.squaredNorm(), stayed = squares + stay * x.squaredNorm();
        EXPECT_NEAR(residuals_only.squaredNorm(), stayed, 1e-9 * stayed + 1e-12);  // not yet linearised here
        EXPECT_NEAR(residuals.squaredNorm(), squares, 1e-9 * squares + 1e-12);
        const Matrix6d jtj = jacobian.transpose() * jacobian + stay * Matrix6d::Identity();
        const Twist jtr = jacobian.transpose() * r;
        EXPECT_LT((tangent.transpose() * tangent - jtj).norm(), 1e-7 * pairs.total_squared_weight);
        EXPECT_LT((tangent.transpose() * residuals - jtr).norm(),
                  1e-7 * std::sqrt(pairs.total_squared_weight) * (r.norm() + 1.0));
    }
};

TEST_P(RegistrationCostOf, EqualsTheRowsOfManyPairs) {
    // 31 is no multiple of the lanes; distances from below one sigma to saturated.
    const Correspondences pairs = ellipsoid_pairs(31, exact_pose(), 1.0);
    expect_equal_to_rows(pairs, exact_pose());
    expect_equal_to_rows(pairs, exact_pose() * exp(make_twist(0.03, -0.02, 0.01, 0.002, -0.001, 0.001)));
    expect_equal_to_rows(pairs, exact_pose() * exp(make_twist(0.9, 0.2, -0.5, 0.02, -0.01, 0.03)));
    expect_equal_to_rows(pairs, exact_pose() * exp(make_twist(0.0, 0.0, 3.1, 0.0, 0.0, 0.0)));
}

TEST_P(RegistrationCostOf, EqualsTheRowsOfPairsThatAllFitOrAllAreOutliers) {
    expect_equal_to_rows(ellipsoid_pairs(7, exact_pose()), exact_pose());  // r = 0
    expect_equal_to_rows(ellipsoid_pairs(7, exact_pose()),
                         exact_pose() * exp(make_twist(0.0, 0.0, 0.0, 0.1, 0.2, -0.3)));
}

TEST_P(RegistrationCostOf, EqualsTheRowsOfOnePlane) {  // a rank of three
    const Correspondences pairs = testing_shapes::plane_pairs({0.3, -0.2, 0.9}, exact_pose());
    expect_equal_to_rows(pairs, exact_pose() * exp(make_twist(0.03, -0.02, 0.01, 0.002, -0.001, 0.001)));
}

TEST_P(RegistrationCostOf, EqualsTheRowsFarFromTheObjectsOrigin) {
    const Correspondences pairs = ellipsoid_pairs(20, exact_pose(), 1.0, {4.0, -2.0, 3.0});
    expect_equal_to_rows(pairs, testing_shapes::exact_pose());
}

TEST_P(RegistrationCostOf, RefusesACostThatIsNotFinite) {
    const Correspondences correspondences = ellipsoid_pairs(20, exact_pose());
    const NormalisedPairs pairs(correspondences, kind);
    const RegistrationCost cost(pairs, {kind, loss, scale}, exact_pose());
    const Twist x = make_twist(0.0, 0.0, 0.0, 0.0, 0.0, 1e200);
    Eigen::Matrix<double, 13, 1> residuals;
    EXPECT_FALSE(cost(x.data(), residuals.data(), nullptr));
    // Ceres' small solver does not ask whether it could be evaluated: it must see that it is worse than anything.
    EXPECT_GT(residuals.squaredNorm(), 1e150);
    EXPECT_TRUE(std::isfinite(residuals.squaredNorm()));
}

std::string name_of(const testing::TestParamInfo<std::tuple<ResidualKind, RobustLoss>>& info) {
    const char* const losses[] = {"None", "Huber", "Cauchy", "Tukey"};
    const bool plane = std::get<0>(info.param) == ResidualKind::kPointToPlane;
    return std::string(plane ? "Plane" : "Point") + losses[static_cast<int>(std::get<1>(info.param))];
}

INSTANTIATE_TEST_SUITE_P(All, RegistrationCostOf,
                         testing::Combine(testing::Values(ResidualKind::kPointToPoint, ResidualKind::kPointToPlane),
                                          testing::Values(RobustLoss::kNone, RobustLoss::kHuber, RobustLoss::kCauchy,
                                                          RobustLoss::kTukey)),
                         name_of);

TEST(NormalisedPairs, FrameIsTheCentroidAndTheSpread) {
    const Correspondences correspondences = ellipsoid_pairs(50, exact_pose(), 0.0, {1.0, 2.0, 3.0});
    const NormalisedPairs pairs(correspondences, ResidualKind::kPointToPlane);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double squares = 0.0;
    for (const auto& block : pairs.blocks) {
        for (int lane = 0; lane < NormalisedPairs::kLanes; ++lane) {
            if (block.weight[lane] == 0.0) continue;
            sum += block.point_in_object.row(lane).transpose().matrix();
            squares += block.point_in_object.row(lane).square().sum();
        }
    }
    EXPECT_LT(sum.norm(), 1e-9);
    EXPECT_NEAR(squares, 50.0, 1e-9);
    const Pose there_and_back = pairs.metric(pairs.normalised(exact_pose()));
    EXPECT_LT(testing_shapes::rotation_error(there_and_back, exact_pose()), 1e-15);
    EXPECT_LT(testing_shapes::translation_error(there_and_back, exact_pose()), 1e-14);
}

}  // namespace
}  // namespace nearpose
