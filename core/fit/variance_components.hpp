// How much larger than the sensor's model says the errors of the image at hand are, judged by a fit to it.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace nearpose {

// Standard deviation of residuals that were divided by their sigmas, from the median of their absolute values: 1 where
// the sigmas are right, whatever a minority of outliers does. 0 without residuals.
double unit_sigma(std::vector<double> scaled_residuals);

// A linear least-squares problem over unknowns of which some are a group: independent, of mean zero and one common
// prior variance. The others have priors of their own (infinite variances for none).
struct GroupProblem {
    Eigen::MatrixXd information;  // of the residuals: J^T W J
    Eigen::VectorXd gradient;     // J^T W r
    Eigen::VectorXd prior_variances;
    Eigen::Index first = 0, count = 0;  // of the group
};

// By what factor the variance of the group's prior is to be multiplied so that the data are most likely: expectation
// maximisation (Dempster, Laird and Rubin 1977) from 1,
//   variance <- mean over the group of (estimate^2 + posterior variance).
// Some steps of it, which go most of the way. 1 for a group of fewer than three, which says next to nothing.
double group_variance_factor(const GroupProblem& problem);

}  // namespace nearpose
