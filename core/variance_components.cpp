#include "core/variance_components.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>

namespace nearpose {

double unit_sigma(std::vector<double> scaled_residuals) {
    if (scaled_residuals.empty()) return 0.0;
    constexpr double kMedianOfUnitNormal = 0.6745;  // of its absolute value
    const auto middle = scaled_residuals.begin() + static_cast<std::ptrdiff_t>(scaled_residuals.size() / 2);
    std::nth_element(scaled_residuals.begin(), middle, scaled_residuals.end());
    return *middle / kMedianOfUnitNormal;
}

double group_variance_factor(const GroupProblem& problem) {
    constexpr int kSteps = 4;
    constexpr Eigen::Index kFewest = 3;
    if (problem.count < kFewest) return 1.0;
    std::vector<Eigen::Index> group, others;
    for (Eigen::Index i = 0; i < problem.gradient.size(); ++i)
        (i >= problem.first && i < problem.first + problem.count ? group : others).push_back(i);
    // What the data say of the group alone, once the others are marginalised out. Its eigenvalues give the trace of the
    // posterior for every variance.
    Eigen::MatrixXd of_others = problem.information(others, others);
    of_others.diagonal() += problem.prior_variances(others).cwiseInverse();
    const Eigen::LLT<Eigen::MatrixXd> solver(of_others);
    const Eigen::MatrixXd coupling = problem.information(others, group);
    const Eigen::MatrixXd information =
        problem.information(group, group) - coupling.transpose() * solver.solve(coupling);
    const Eigen::VectorXd gradient =
        problem.gradient(group) - coupling.transpose() * solver.solve(problem.gradient(others));
    const Eigen::ArrayXd eigenvalues =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(information, Eigen::EigenvaluesOnly).eigenvalues();
    const double prior = problem.prior_variances[problem.first];
    double factor = 1.0;
    for (int step = 0; step < kSteps; ++step) {
        const double inverse = 1.0 / (factor * prior);
        Eigen::MatrixXd matrix = information;
        matrix.diagonal().array() += inverse;
        const Eigen::VectorXd estimate = matrix.llt().solve(gradient);
        const double posterior = (eigenvalues.max(0.0) + inverse).inverse().sum();
        factor = (estimate.squaredNorm() + posterior) / (static_cast<double>(problem.count) * prior);
    }
    return factor;
}

}  // namespace nearpose
