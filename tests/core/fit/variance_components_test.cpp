#include "core/fit/variance_components.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <limits>

#include "core/base/random.hpp"

namespace nearpose {
namespace {

constexpr Eigen::Index kOthers = 4, kGroup = 30, kRows = 200;
constexpr double kNoise = 0.1, kPrior = 0.01;

// Random rows of (others, group), and residuals of a group whose variance is `true_factor` times its prior's.
GroupProblem draw_problem(double true_factor, std::uint64_t seed) {
    RandomStream random(seed, 0, 0, RandomPurpose::kStart);
    Eigen::MatrixXd rows(kRows, kOthers + kGroup);
    for (double& value : rows.reshaped()) value = random.gaussian();
    Eigen::VectorXd truth(kOthers + kGroup);
    for (Eigen::Index i = 0; i < truth.size(); ++i)
        truth[i] = random.gaussian() * (i < kOthers ? 1.0 : std::sqrt(true_factor * kPrior));
    Eigen::VectorXd residuals = rows * truth;
    for (double& value : residuals) value += kNoise * random.gaussian();
    GroupProblem problem;
    problem.information = rows.transpose() * rows / (kNoise * kNoise);
    problem.gradient = rows.transpose() * residuals / (kNoise * kNoise);
    problem.prior_variances = Eigen::VectorXd::Constant(kOthers + kGroup, kPrior);
    problem.prior_variances.head(kOthers).setConstant(std::numeric_limits<double>::infinity());
    problem.first = kOthers;
    problem.count = kGroup;
    return problem;
}

// Expectation maximisation as it is defined, with the whole matrix inverted.
double naive_factor(const GroupProblem& problem) {
    double factor = 1.0;
    for (int step = 0; step < GroupVarianceOptions{}.steps; ++step) {
        Eigen::VectorXd variances = problem.prior_variances;
        variances.segment(problem.first, problem.count) *= factor;
        Eigen::MatrixXd matrix = problem.information;
        matrix.diagonal() += variances.cwiseInverse();
        const Eigen::MatrixXd posterior = matrix.inverse();
        const Eigen::VectorXd estimate = posterior * problem.gradient;
        const Eigen::VectorXd squares = estimate.cwiseAbs2() + posterior.diagonal();
        factor = squares.segment(problem.first, problem.count).mean() / kPrior;
    }
    return factor;
}

TEST(VarianceComponents, TheUnitSigmaIsThatOfTheMajorityWhateverTheOutliers) {
    RandomStream random(3, 0, 0, RandomPurpose::kStart);
    std::vector<double> residuals;
    for (int i = 0; i < 20000; ++i) residuals.push_back(std::abs(1.7 * random.gaussian()));
    EXPECT_NEAR(unit_sigma(residuals), 1.7, 0.04);
    for (int i = 0; i < 1000; ++i) residuals.push_back(1e6);
    EXPECT_NEAR(unit_sigma(residuals), 1.8, 0.1) << "5 % of outliers move a median by a fifteenth";
    EXPECT_EQ(unit_sigma({}), 0.0);
}

TEST(VarianceComponents, TheGroupsFactorIsThatOfTheInvertedMatrix) {
    for (const double true_factor : {0.2, 1.0, 9.0}) {
        const GroupProblem problem = draw_problem(true_factor, 11);
        EXPECT_NEAR(group_variance_factor(problem), naive_factor(problem), 1e-6 * naive_factor(problem));
    }
}

TEST(VarianceComponents, TheGroupsFactorIsFoundFromTheData) {
    constexpr int kTrials = 40;
    for (const double true_factor : {0.25, 1.0, 4.0, 16.0}) {
        double mean = 0.0;
        for (int trial = 0; trial < kTrials; ++trial)
            mean += group_variance_factor(draw_problem(true_factor, 100 + trial)) / kTrials;
        // The mean square of 30 normal numbers scatters by 26 %, that of 40 trials by 4 %.
        EXPECT_NEAR(mean, true_factor, 0.15 * true_factor);
    }
}

TEST(VarianceComponents, TwoUnknownsSayTooLittleAboutTheirVariance) {
    GroupProblem problem = draw_problem(100.0, 5);
    problem.count = 2;
    EXPECT_EQ(group_variance_factor(problem), 1.0);
}

}  // namespace
}  // namespace nearpose
