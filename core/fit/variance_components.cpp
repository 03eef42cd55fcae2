#include "core/fit/variance_components.hpp"

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

namespace {

// Of a group whose data say T, tridiagonal, and whose prior's inverse variance is `inverse`: |estimate|^2 + the trace
// of the posterior's covariance. T + inverse I is factored from both ends: what either end leaves of a diagonal element
// gives the inverse's.
double sum_of_squares(const Eigen::VectorXd& diagonal, const Eigen::VectorXd& beside, double inverse,
                      const Eigen::VectorXd& gradient) {
    const Eigen::Index count = diagonal.size();
    Eigen::VectorXd from_first = diagonal.array() + inverse, from_last = from_first, estimate = gradient;
    for (Eigen::Index i = 1; i < count; ++i) {
        const double ratio = beside[i - 1] / from_first[i - 1];
        from_first[i] = std::max(inverse, from_first[i] - ratio * beside[i - 1]);  // never less, but for rounding
        estimate[i] -= ratio * estimate[i - 1];
    }
    for (Eigen::Index i = count - 2; i >= 0; --i)
        from_last[i] = std::max(inverse, from_last[i] - beside[i] * beside[i] / from_last[i + 1]);
    for (Eigen::Index i = count - 1; i >= 0; --i) {
        if (i + 1 < count) estimate[i] -= beside[i] * estimate[i + 1];
        estimate[i] /= from_first[i];
    }
    const Eigen::ArrayXd inverse_of_posterior = (from_first + from_last - diagonal).array() - inverse;
    return estimate.squaredNorm() + inverse_of_posterior.max(inverse).inverse().sum();
}

}  // namespace

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
    // The same in tridiagonal form, which is solved and inverted in no time for every variance.
    const Eigen::Tridiagonalization<Eigen::MatrixXd> tridiagonal(information);
    const Eigen::VectorXd turned_gradient = tridiagonal.matrixQ().adjoint() * gradient;
    const double prior = problem.prior_variances[problem.first];
    double factor = 1.0;
    for (int step = 0; step < kSteps; ++step) {
        const double inverse = 1.0 / (factor * prior);
        const double squares =
            sum_of_squares(tridiagonal.diagonal(), tridiagonal.subDiagonal(), inverse, turned_gradient);
        factor = squares / (static_cast<double>(problem.count) * prior);
    }
    return factor;
}

}  // namespace nearpose
