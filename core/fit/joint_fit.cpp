#include "core/fit/joint_fit.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/fit/fit_rays.hpp"
#include "core/fit/sensor_field.hpp"
#include "core/fit/variance_components.hpp"

namespace nearpose {
namespace {

constexpr int kMaxRounds = 4;
constexpr double kPartScaleSigma = 0.001;  // a part is so much larger or smaller than its CAD, of itself

View cast(const Pose& camera_from_object, const StepContext& context) {
    return context.views.generate(camera_from_object, context.observed.camera);
}

// How far the rays' residuals are beyond their sigmas. Beyond 1 it is not the sensor: CAD, edges and dirt add to it.
struct Misfit {
    double unit_sigma = 0.0;

    double unit_variance() const { return std::max(1.0, unit_sigma * unit_sigma); }
    // The sensor's model is on the wide side: where it holds, residuals come out at about kUsual, and a noise of more
    // than that is more than the model's.
    double noise_variance() const {
        constexpr double kUsual = 0.7;
        return std::max(1.0, unit_sigma * unit_sigma / (kUsual * kUsual));
    }
};

// What is solved: the pose and those of the unknowns that some ray met; of the others nothing is learned.
struct Problem {
    std::vector<Eigen::Index> active;  // of the pose and the unknowns
    Eigen::Index active_nodes = 0;     // of the field, after the pose
    Eigen::MatrixXd information;       // of the rays, over the active ones
    Eigen::VectorXd gradient;
    Eigen::VectorXd of_part_scale;     // what the gradient is for a part that is larger than its CAD by all of itself
    Eigen::VectorXd variances;         // of the active unknowns
    Eigen::VectorXd fitted_variances;  // with which they take part in the fit
};

// Of what is no error of the sensor, its errors explain the less.
SensorModel fitted_part(const SensorModel& sensor, const Misfit& misfit) {
    SensorModel fitted = sensor;
    fitted.systematic_sigma_m *= sensor.systematic_fitted / misfit.unit_variance();
    fitted.depth_scale_sigma *= sensor.scale_fitted;
    return fitted;
}

Problem problem_of(const FitEquations& equations, const Misfit& misfit, const SensorField& field,
                   const StepContext& context) {
    const SensorModel& sensor = context.observation.sensor();
    Problem problem;
    const Eigen::Index part_scale = 6 + field.num_unknowns(), residual = part_scale + 1;
    for (Eigen::Index i = 0; i < part_scale; ++i) {
        if (i >= 6 && !(equations.sums(i, i) > 0.0)) continue;
        problem.active.push_back(i);
        problem.active_nodes += i >= 6 && i < 6 + field.num_nodes();
    }
    problem.information = equations.sums(problem.active, problem.active) / misfit.unit_variance();
    problem.gradient = equations.sums(problem.active, residual) / misfit.unit_variance();
    problem.of_part_scale = equations.sums(problem.active, part_scale) / misfit.unit_variance();
    const double diameter_m = context.views.extent().diameter_m();  // a weak prior of the pose
    problem.information.diagonal().head<3>().array() += 1.0;
    problem.information.diagonal().segment<3>(3).array() += 1.0 / (diameter_m * diameter_m);
    // An image that is far noisier than the sensor's model is no better in what its pixels share.
    constexpr double kUsual = 1.5;  // up to which the model may be off in its noise alone
    const double worse = std::max(1.0, context.observation.noise_factor() / kUsual);
    const Eigen::VectorXd all = worse * worse * prior_variances(field, sensor);
    const Eigen::VectorXd all_fitted = prior_variances(field, fitted_part(sensor, misfit));
    const std::vector<Eigen::Index> beside_pose(problem.active.begin() + 6, problem.active.end());
    problem.variances.resize(static_cast<Eigen::Index>(beside_pose.size()));
    problem.fitted_variances.resize(problem.variances.size());
    for (Eigen::Index i = 0; i < problem.variances.size(); ++i) {
        problem.variances[i] = all[beside_pose[i] - 6];
        problem.fitted_variances[i] = all_fitted[beside_pose[i] - 6];
    }
    return problem;
}

Eigen::LLT<Eigen::MatrixXd> factor_of(const Problem& problem) {
    Eigen::MatrixXd matrix = problem.information;
    matrix.diagonal().tail(problem.fitted_variances.size()) += problem.fitted_variances.cwiseInverse();
    return matrix.llt();
}

// The sensor's field may be larger than its model says, and the image shows by how much.
Problem with_larger_field(Problem problem) {
    GroupProblem group{problem.information, problem.gradient, Eigen::VectorXd(problem.gradient.size()), 6,
                       problem.active_nodes};
    group.prior_variances << Eigen::VectorXd::Constant(6, std::numeric_limits<double>::infinity()), problem.variances;
    problem.variances.head(problem.active_nodes) *= std::max(1.0, group_variance_factor(group));
    return problem;
}

// Of the fit's pose when the sensor's errors have their whole variances, while the fit takes them for smaller: with the
// fit's matrix M, whose prior of the errors is L, the estimate's error is M^-1 (noise - L errors), hence its covariance
// M^-1 (J^T W J + L V L) M^-1.
Matrix6d covariance_of(const Problem& problem, const Misfit& misfit, const Eigen::LLT<Eigen::MatrixXd>& factor) {
    Eigen::MatrixXd spread = problem.information * (misfit.noise_variance() / misfit.unit_variance());
    spread.diagonal().tail(problem.variances.size()) +=
        problem.fitted_variances.cwiseAbs2().cwiseInverse().cwiseProduct(problem.variances);
    const Eigen::MatrixXd gain = factor.solve(Eigen::MatrixXd::Identity(spread.rows(), 6));
    const Matrix6d covariance = gain.transpose() * (spread * gain);
    return 0.5 * (covariance + covariance.transpose());
}

// The part's scale can hardly be told from its distance: it is reckoned with, not fitted.
Matrix6d part_scale_covariance(const Problem& problem, const Eigen::LLT<Eigen::MatrixXd>& factor) {
    const Twist shift = kPartScaleSigma * factor.solve(problem.of_part_scale).head<6>();
    return shift * shift.transpose();
}

}  // namespace

JointFit fit_jointly(const Pose& start, const StepContext& context) {
    const SensorModel& sensor = context.observation.sensor();
    const SensorField field = field_over(context.observation.camera(), sensor);
    const ModelExtent& extent = context.views.extent();
    const double sigma_m = context.observation.sigma_m(context.observation.mean_distance_m());
    // Of any of the model's points: less than the first is nothing, less than the second meets the same faces.
    const double nothing_m = 0.2 * sigma_m, same_faces_m = sigma_m;
    Linearisation at{start, Eigen::VectorXd::Zero(field.num_unknowns()), 0.0};
    JointFit fit;
    View view = cast(start, context);
    for (int round = 0; round < kMaxRounds; ++round) {
        // A start that is off by little more than the noise is drawn in from farther at first.
        at.extra_sigma_m = round == 0 ? 2.0 * sensor.systematic_sigma_m : 0.0;
        const FitEquations equations = linearise(at, view, field, context);
        const Misfit misfit{round == 0 ? 0.0 : unit_sigma(equations.scaled_residuals)};  // none before it was fitted
        const Problem problem = problem_of(equations, misfit, field, context);
        const Eigen::LLT<Eigen::MatrixXd> factor = factor_of(problem);
        const Eigen::VectorXd step = factor.solve(problem.gradient);
        const Pose moved = perturb_about(at.camera_from_object, step.head<6>(), extent.centre_in_object());
        const double shift_m = step.segment<3>(3).norm() + 0.5 * extent.diameter_m() * step.head<3>().norm();
        const bool usable = is_valid(moved);
        const bool last = !usable || round + 1 == kMaxRounds || (round > 0 && shift_m < nothing_m);
        if (usable) {
            at.camera_from_object = moved;
            for (std::size_t i = 6; i < problem.active.size(); ++i)
                at.errors[problem.active[i] - 6] = step[static_cast<Eigen::Index>(i)];
        }
        if (last) {
            fit.covariance = covariance_of(with_larger_field(problem), misfit, factor);
            fit.constant_covariance = part_scale_covariance(problem, factor);
        }
        fit.pairs = static_cast<int>(equations.scaled_residuals.size());
        if (last) break;
        if (shift_m > same_faces_m) view = cast(at.camera_from_object, context);
    }
    fit.camera_from_object = at.camera_from_object;
    return fit;
}

Matrix6d covariance_at(const Pose& camera_from_object, const StepContext& context) {
    const SensorField field = field_over(context.observation.camera(), context.observation.sensor());
    const Linearisation at{camera_from_object, Eigen::VectorXd::Zero(field.num_unknowns()), 0.0};
    const Problem problem =
        problem_of(linearise(at, cast(camera_from_object, context), field, context), {}, field, context);
    const Eigen::LLT<Eigen::MatrixXd> factor = factor_of(problem);
    return covariance_of(problem, {}, factor) + part_scale_covariance(problem, factor);
}

Matrix6d about_origin(const Matrix6d& covariance_about_centre, const Eigen::Vector3d& centre_in_object) {
    Matrix6d map = Matrix6d::Identity();  // a turn about the centre moves the origin
    map.bottomLeftCorner<3, 3>() = skew(centre_in_object);
    return map * covariance_about_centre * map.transpose();
}

Matrix6d about_centre(const Matrix6d& covariance_about_origin, const Eigen::Vector3d& centre_in_object) {
    return about_origin(covariance_about_origin, -centre_in_object);
}

}  // namespace nearpose
