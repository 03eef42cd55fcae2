#include "core/fit/joint_fit.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/check.hpp"

namespace nearpose {
namespace {

View cast(const Pose& camera_from_object, const StepContext& context) {
    return context.views.generate(camera_from_object, context.observed.camera);
}

// The variance of unit weight (Foerstner and Wrobel 2016): how much larger the squared residuals are than their
// variances. Beyond 1 the cause is not the sensor: CAD, edges and dirt add to it.
class UnitWeight {
  public:
    UnitWeight() = default;  // before anything was fitted: 1
    UnitWeight(double unit_sigma, const FitOptions& options)
        : variance_(std::max(1.0, unit_sigma * unit_sigma)),
          noise_variance_(
              std::max(1.0, unit_sigma * unit_sigma / (options.usual_unit_sigma * options.usual_unit_sigma))) {}

    double variance() const { return variance_; }              // for the fit's weights
    double noise_variance() const { return noise_variance_; }  // for the covariance

  private:
    double variance_ = 1.0, noise_variance_ = 1.0;
};

// What is solved: the pose and those unknowns that some ray measures.
struct Problem {
    std::vector<Eigen::Index> active;  // indices among the pose (the first six) and the unknowns
    Eigen::Index active_nodes = 0;     // of the field; they follow the pose
    Eigen::MatrixXd information;       // of the rays, over the active ones
    Eigen::VectorXd gradient;
    Eigen::MatrixXd constant_gradients;  // a column for each constant error of size 1: what the fit takes it for
    Eigen::VectorXd variances;           // prior, of the active unknowns
    Eigen::VectorXd fitted_variances;    // the smaller ones with which they take part in the fit
};

// The sensor's errors as the fit may use them. The larger the residuals that are no error of the sensor, the less of
// them its errors may explain.
SensorModel fitted_part(const SensorModel& sensor, const UnitWeight& weight) {
    SensorModel fitted = sensor;
    fitted.systematic_sigma_m *= sensor.systematic_fitted / weight.variance();
    fitted.depth_scale_sigma *= sensor.scale_fitted;
    return fitted;
}

// The prior variances of the active unknowns. An image that is far noisier than the sensor's model is taken to be worse
// in the errors that its pixels share as well.
void set_prior(Problem& problem, const UnitWeight& weight, const SensorField& field, const Observation& observation,
               const FitOptions& options) {
    const double worse = std::max(1.0, observation.noise_factor() / options.usual_noise_factor);
    const Eigen::VectorXd all = worse * worse * prior_variances(field, observation.sensor());
    const Eigen::VectorXd all_fitted = prior_variances(field, fitted_part(observation.sensor(), weight));
    const std::vector<Eigen::Index> beside_pose(problem.active.begin() + 6, problem.active.end());
    problem.variances.resize(static_cast<Eigen::Index>(beside_pose.size()));
    problem.fitted_variances.resize(problem.variances.size());
    for (Eigen::Index i = 0; i < problem.variances.size(); ++i) {
        problem.variances[i] = all[beside_pose[i] - 6];
        problem.fitted_variances[i] = all_fitted[beside_pose[i] - 6];
    }
}

Problem problem_of(const FitEquations& equations, const UnitWeight& weight, const SensorField& field,
                   const StepContext& context, const FitOptions& options) {
    Problem problem;
    const Eigen::Index constants = 6 + field.num_unknowns(), residual = constants + kConstantErrors;
    for (Eigen::Index i = 0; i < constants; ++i) {
        if (i >= 6 && !(equations.sums(i, i) > 0.0)) continue;
        problem.active.push_back(i);
        problem.active_nodes += i >= 6 && i < 6 + field.num_nodes();
    }
    problem.information = equations.sums(problem.active, problem.active) / weight.variance();
    problem.gradient = equations.sums(problem.active, residual) / weight.variance();
    problem.constant_gradients =
        equations.sums(problem.active, Eigen::seqN(constants, kConstantErrors)) / weight.variance();
    const double turn_rad = options.prior_rotation_rad;
    const double shift_m = options.prior_translation_diameters * context.views.extent().diameter_m();
    problem.information.diagonal().head<3>().array() += 1.0 / (turn_rad * turn_rad);
    problem.information.diagonal().segment<3>(3).array() += 1.0 / (shift_m * shift_m);
    set_prior(problem, weight, field, context.observation, options);
    return problem;
}

Eigen::LLT<Eigen::MatrixXd> factor_of(const Problem& problem) {
    Eigen::MatrixXd matrix = problem.information;
    matrix.diagonal().tail(problem.fitted_variances.size()) += problem.fitted_variances.cwiseInverse();
    return matrix.llt();
}

// The sensor's field may be larger or smaller than its model says; the image shows by how much. Where it is smaller,
// the sensor is a better one, and its scale is believed as much more. A smaller one is believed as far as nodes tell.
Problem with_seen_field(Problem problem, const GroupVarianceOptions& options) {
    GroupProblem group{problem.information, problem.gradient, Eigen::VectorXd(problem.gradient.size()), 6,
                       problem.active_nodes};
    group.prior_variances << Eigen::VectorXd::Constant(6, std::numeric_limits<double>::infinity()), problem.variances;
    const double seen = group_variance_factor(group, options);
    const auto nodes = static_cast<double>(problem.active_nodes);
    const double factor = seen > 1.0 ? seen : (options.prior_count + nodes * seen) / (options.prior_count + nodes);
    problem.variances.head(problem.active_nodes) *= factor;
    problem.variances.tail(problem.variances.size() - problem.active_nodes) *= std::min(1.0, factor);
    return problem;
}

// The standard deviation of the smooth field that the image shows [m]; the sensor model's where no ray measures it.
double seen_field_sigma_m(const Problem& problem, const Problem& seen, const SensorModel& sensor) {
    if (problem.active_nodes == 0) return sensor.systematic_sigma_m;
    return sensor.systematic_sigma_m * std::sqrt(seen.variances[0] / problem.variances[0]);
}

// The covariance of the fitted pose. The sensor's errors have their whole variances V, but the fit takes them for
// smaller. With the fit's matrix M, whose prior of the errors is L, the estimate is off by M^-1 (J^T W noise - L
// errors) and its covariance is M^-1 (J^T W J + L V L) M^-1.
Matrix6d covariance_of(const Problem& problem, const UnitWeight& weight, const Eigen::LLT<Eigen::MatrixXd>& factor) {
    Eigen::MatrixXd spread = problem.information * (weight.noise_variance() / weight.variance());
    spread.diagonal().tail(problem.variances.size()) +=
        problem.fitted_variances.cwiseAbs2().cwiseInverse().cwiseProduct(problem.variances);
    const Eigen::MatrixXd gain = factor.solve(Eigen::MatrixXd::Identity(spread.rows(), 6));
    const Matrix6d covariance = gain.transpose() * (spread * gain);
    return 0.5 * (covariance + covariance.transpose());
}

// Constant errors can hardly be told from the pose, so they are not fitted: their effect on it is propagated.
Matrix6d constant_covariance_of(const Problem& problem, const Eigen::LLT<Eigen::MatrixXd>& factor,
                                const Observation& observation, const FitOptions& options) {
    const SensorModel& sensor = observation.sensor();
    const double shift_pixels = observation.shared_noise() * sensor.image_shift_sigma_pixels;
    const Eigen::Vector4d sigmas(options.part_scale_sigma, sensor.focal_length_sigma, shift_pixels, shift_pixels);
    static_assert(kConstantErrors == 4);
    const Eigen::Matrix<double, 6, kConstantErrors> steps =
        factor.solve(problem.constant_gradients).topRows<6>() * sigmas.asDiagonal();
    return steps * steps.transpose();
}

// The scale of the depth is an unknown beside the pose; without rays that measure it, it has no effect.
SetupEffect setup_effect_of(const Problem& problem, const Eigen::LLT<Eigen::MatrixXd>& factor, Eigen::Index scale) {
    SetupEffect effect = SetupEffect::Zero();
    const Eigen::MatrixXd constants = factor.solve(problem.constant_gradients);
    effect.leftCols<3>() = constants.topRows<6>().rightCols<3>();
    if (problem.active.back() == scale)
        effect.col(kDepthScaleError) = Eigen::VectorXd(factor.solve(problem.information.rightCols<1>())).head<6>();
    return effect;
}

}  // namespace

void validate(const FitOptions& options) {
    check_option("fit.max_rounds", options.max_rounds, 1, 100);
    check_option("fit.first_extra_field_sigmas", options.first_extra_field_sigmas, 0.0, 1e3);
    check_option("fit.converged_sigmas", options.converged_sigmas, 0.0, 1e3);
    check_option("fit.same_faces_sigmas", options.same_faces_sigmas, 0.0, 1e3);
    check_option("fit.prior_rotation_rad", options.prior_rotation_rad, 1e-6, 1e6);
    check_option("fit.prior_translation_diameters", options.prior_translation_diameters, 1e-6, 1e6);
    check_option("fit.part_scale_sigma", options.part_scale_sigma, 0.0, 1.0);
    check_option("fit.usual_unit_sigma", options.usual_unit_sigma, 1e-3, 1e3);
    check_option("fit.usual_noise_factor", options.usual_noise_factor, 1e-3, 1e3);
    check_option("fit.rays.gate_sigmas", options.rays.gate_sigmas, 0.1, 1e3);
    check_option("fit.rays.huber_sigmas", options.rays.huber_sigmas, 0.1, 1e3);
    check_option("fit.rays.reach_spacings", options.rays.reach_spacings, 0.0, 10.0);
    check_option("fit.rays.coplanar_sine", options.rays.coplanar_sine, 0.0, 1.0);
    check_option("fit.field.spacing_lengths", options.field.spacing_lengths, 0.1, 1e3);
    check_option("fit.field.max_spacings", options.field.max_spacings, 1.0, 1e3);
    check_option("fit.field_variance.prior_count", options.field_variance.prior_count, 0.0, 1e6);
    check_option("fit.field_variance.steps", options.field_variance.steps, 0, 1000);
    check_option("fit.field_variance.min_count", options.field_variance.min_count, 1, 1e6);
}

JointFit fit_jointly(const Pose& start, const StepContext& context, const FitOptions& options) {
    const SensorModel& sensor = context.observation.sensor();
    const SensorField field = field_over(context.observation.camera(), sensor, options.field);
    const ModelExtent& extent = context.views.extent();
    const double sigma_m = context.observation.sigma_m(context.observation.mean_distance_m());
    Linearisation at{start, Eigen::VectorXd::Zero(field.num_unknowns()), 0.0};
    JointFit fit;
    View view = cast(start, context);
    for (int round = 0; round < options.max_rounds; ++round) {
        at.extra_sigma_m = round == 0 ? options.first_extra_field_sigmas * sensor.systematic_sigma_m : 0.0;
        const FitEquations equations = linearise(at, view, field, context, options.rays);
        const UnitWeight weight =
            round == 0 ? UnitWeight{} : UnitWeight{unit_sigma(equations.scaled_residuals), options};
        const Problem problem = problem_of(equations, weight, field, context, options);
        const Eigen::LLT<Eigen::MatrixXd> factor = factor_of(problem);
        const Eigen::VectorXd step = factor.solve(problem.gradient);
        const Pose moved = perturb_about(at.camera_from_object, step.head<6>(), extent.centre_in_object());
        // An upper bound of how far any point of the model moves.
        const double shift_m = step.segment<3>(3).norm() + 0.5 * extent.diameter_m() * step.head<3>().norm();
        const bool usable = is_valid(moved);
        const bool converged = round > 0 && shift_m < options.converged_sigmas * sigma_m;
        const bool last = !usable || round + 1 == options.max_rounds || converged;
        if (usable) {
            at.camera_from_object = moved;
            for (std::size_t i = 6; i < problem.active.size(); ++i)
                at.errors[problem.active[i] - 6] = step[static_cast<Eigen::Index>(i)];
        }
        if (last) {
            const Problem seen = with_seen_field(problem, options.field_variance);
            fit.shared_sigma_m = seen_field_sigma_m(problem, seen, sensor);
            fit.covariance = covariance_of(seen, weight, factor);
            fit.constant_covariance = constant_covariance_of(problem, factor, context.observation, options);
            fit.setup_effect = setup_effect_of(problem, factor, 6 + field.num_nodes());
        }
        fit.pairs = equations.rays;
        if (last) break;
        if (shift_m > options.same_faces_sigmas * sigma_m) view = cast(at.camera_from_object, context);
    }
    fit.camera_from_object = at.camera_from_object;
    return fit;
}

Matrix6d covariance_at(const Pose& camera_from_object, const StepContext& context, const FitOptions& options) {
    const SensorField field = field_over(context.observation.camera(), context.observation.sensor(), options.field);
    const Linearisation at{camera_from_object, Eigen::VectorXd::Zero(field.num_unknowns()), 0.0};
    const View view = cast(camera_from_object, context);
    const Problem problem = problem_of(linearise(at, view, field, context, options.rays), {}, field, context, options);
    const Eigen::LLT<Eigen::MatrixXd> factor = factor_of(problem);
    return covariance_of(problem, {}, factor) + constant_covariance_of(problem, factor, context.observation, options);
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
