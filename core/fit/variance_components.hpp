// How much larger the errors of one image are than the sensor's model says, judged by a fit to that image.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace nearpose {

// Square root of the variance of unit weight: the standard deviation of residuals that were divided by their sigmas.
// It is 1 where the sigmas are right. Taken from the median of the absolute values, so that a minority of outliers
// hardly changes it. 0 without residuals.
double unit_sigma(std::vector<double> scaled_residuals);

// A linear least-squares problem in which some unknowns form a group: independent, of mean zero and one common prior
// variance. The others have priors of their own, infinite variances for none.
struct GroupProblem {
    Eigen::MatrixXd information;  // of the residuals: J^T W J
    Eigen::VectorXd gradient;     // J^T W r
    Eigen::VectorXd prior_variances;
    Eigen::Index first = 0, count = 0;  // of the group
};

struct GroupVarianceOptions {
    int steps = 16;            // of expectation maximisation; they go most of the way
    int min_count = 3;         // smaller groups say next to nothing about their variance
    double prior_count = 2.0;  // against a smaller variance the sensor's model counts as so many of the group
};

// The factor on the group's prior variance under which the data are most likely. Found by expectation maximisation
// (Dempster, Laird and Rubin 1977), which begins with the prior itself:
//   variance <- mean over the group of (estimate^2 + posterior variance).
// 1 for a group of fewer than `min_count`.
double group_variance_factor(const GroupProblem& problem, const GroupVarianceOptions& options = {});

}  // namespace nearpose
