#include "core/fit/variance_components.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <utility>

#include "core/base/statistics.hpp"

namespace nearpose {

double unit_sigma(std::vector<double> scaled_residuals) {
    if (scaled_residuals.empty()) return 0.0;
    return median(std::move(scaled_residuals)) / kMedianOfAbsoluteNormal;
}

namespace {

// |estimate|^2 + trace of the posterior covariance, for a group with tridiagonal information T and prior I / `inverse`.
// T + inverse I is factored from both ends. What the two factorisations leave of a diagonal element gives the diagonal
// element of the inverse, in linear time.
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

double group_variance_factor(const GroupProblem& problem, const GroupVarianceOptions& options) {
    if (problem.count < options.min_count) return 1.0;
    std::vector<Eigen::Index> group, others;
    for (Eigen::Index i = 0; i < problem.gradient.size(); ++i)
        (i >= problem.first && i < problem.first + problem.count ? group : others).push_back(i);
    // The group's own problem, with the others marginalised out (Schur complement).
    Eigen::MatrixXd of_others = problem.information(others, others);
    of_others.diagonal() += problem.prior_variances(others).cwiseInverse();
    const Eigen::LLT<Eigen::MatrixXd> solver(of_others);
    const Eigen::MatrixXd coupling = problem.information(others, group);
    const Eigen::MatrixXd information =
        problem.information(group, group) - coupling.transpose() * solver.solve(coupling);
    const Eigen::VectorXd gradient =
        problem.gradient(group) - coupling.transpose() * solver.solve(problem.gradient(others));
    // In tridiagonal form it is solved and inverted in linear time for every variance that is tried.
    const Eigen::Tridiagonalization<Eigen::MatrixXd> tridiagonal(information);
    const Eigen::VectorXd turned_gradient = tridiagonal.matrixQ().adjoint() * gradient;
    const double prior = problem.prior_variances[problem.first];
    double factor = 1.0;
    for (int step = 0; step < options.steps; ++step) {
        const double inverse = 1.0 / (factor * prior);
        const double squares =
            sum_of_squares(tridiagonal.diagonal(), tridiagonal.subDiagonal(), inverse, turned_gradient);
        factor = squares / (static_cast<double>(problem.count) * prior);
    }
    return factor;
}

}  // namespace nearpose
