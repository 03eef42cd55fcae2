#include "core/fine_fit.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/sensor_field.hpp"

namespace nearpose {
namespace {

constexpr int kRounds = 3;
constexpr double kGateSigmas = 5.0;   // a pair farther off than that is not the same surface
constexpr double kHuberSigmas = 2.0;  // beyond it a residual pulls with constant force

// The normal equations of one round over (twist about the centre, unknowns of the field), at the pose and at zero
// errors of the sensor.
struct NormalEquations {
    Eigen::MatrixXd information;
    Eigen::VectorXd gradient;
    int pairs = 0;
};

struct Linearisation {
    Pose camera_from_object;
    Eigen::VectorXd errors;  // of the sensor, as far as is known: for weights and gate
    double extra_sigma_m = 0.0;
};

// So many rays share one of the errors that are finer than the field's nodes: each counts with that error, not with its
// mean.
double rays_per_fine_error(const SensorModel& sensor, int stride) {
    const double side = std::max(1.0, 0.25 * sensor.systematic_length_pixels / stride);
    return side * side;
}

NormalEquations linearise(const Linearisation& at, const SensorField& field, const StepContext& context) {
    const ObservedGrid& observed = context.observed;
    const SensorModel& sensor = context.observation.sensor();
    const Eigen::Vector3d centre = context.views.extent().centre_in_object();
    const Eigen::Matrix3d rotation = at.camera_from_object.rotation_matrix();
    const View view = context.views.generate(at.camera_from_object, observed.camera);
    const double fine_m2 = sensor.systematic_fine_sigma_m * sensor.systematic_fine_sigma_m;
    const double shared = rays_per_fine_error(sensor, observed.grid.stride);
    const double field_m2 = sensor.systematic_sigma_m * sensor.systematic_sigma_m;
    const int unknowns = field.num_unknowns();
    NormalEquations sum{Eigen::MatrixXd::Zero(6 + unknowns, 6 + unknowns), Eigen::VectorXd::Zero(6 + unknowns), 0};
    for (std::size_t k = 0; k < view.size(); ++k) {
        const int index = view.pixels[k];
        if (observed.states[index] != PixelState::kCandidate) continue;
        const Eigen::Vector3d point = view.points_in_object[k].cast<double>();
        const Eigen::Vector3d normal = view.normals_in_object[k].cast<double>();
        const double model_m = rotation.row(2).dot(point) + at.camera_from_object.translation.z();
        const double measured_m = observed.depth_m[index];
        const Eigen::Vector3d ray = observed.camera.ray(index % observed.grid.width, index / observed.grid.width);
        const double slope = normal.dot(rotation.transpose() * ray);  // metres along the normal per metre of depth
        const double residual_m = (measured_m - model_m) * slope;
        const SensorField::Row row =
            field.row_at(observed.grid.image_u(index), observed.grid.image_v(index), measured_m);
        double known_m = 0.0;
        for (int i = 0; i < 5; ++i) known_m += row.factors[i] * at.errors[row.unknowns[i]];
        const double sensor_m = sensor.sigma_along_normal_m(
            observed.sigma_m[index], measured_m, rotation.row(2).dot(normal), context.observation.camera().fx);
        const double squared_slope = slope * slope;
        const double sigma_m =
            std::sqrt(sensor_m * sensor_m + fine_m2 * squared_slope + at.extra_sigma_m * at.extra_sigma_m);
        const double off_m = std::abs(residual_m - slope * known_m);
        if (off_m > kGateSigmas * std::sqrt(sigma_m * sigma_m + field_m2 * squared_slope)) continue;
        const double robust = std::min(1.0, kHuberSigmas * sigma_m / std::max(off_m, 1e-12));
        const double weight = robust / (sigma_m * sigma_m + (shared - 1.0) * fine_m2 * squared_slope);
        Twist jacobian;
        jacobian << (point - centre).cross(normal), normal;
        sum.information.topLeftCorner<6, 6>().noalias() += weight * jacobian * jacobian.transpose();
        sum.gradient.head<6>() += weight * residual_m * jacobian;
        for (int i = 0; i < 5; ++i) {
            const double factor = weight * slope * row.factors[i];
            const int unknown = 6 + row.unknowns[i];
            sum.information.block<6, 1>(0, unknown) += factor * jacobian;
            sum.gradient[unknown] += factor * residual_m;
            for (int j = 0; j < 5; ++j)
                sum.information(unknown, 6 + row.unknowns[j]) += factor * slope * row.factors[j];
        }
        ++sum.pairs;
    }
    sum.information.bottomLeftCorner(unknowns, 6) = sum.information.topRightCorner(6, unknowns).transpose();
    return sum;
}

// The variances with which the unknowns of the field take part in the fit.
Eigen::VectorXd fitted_variances(const SensorField& field, const SensorModel& sensor) {
    SensorModel fitted = sensor;
    fitted.systematic_sigma_m *= sensor.systematic_fitted;
    fitted.depth_scale_sigma *= sensor.scale_fitted;
    return prior_variances(field, fitted);
}

void add_weak_prior(Eigen::MatrixXd& information, double diameter_m) {
    information.diagonal().head<3>().array() += 1.0;
    information.diagonal().segment<3>(3).array() += 1.0 / (diameter_m * diameter_m);
}

// Of the fit's pose when the sensor's errors have their whole variances, while the fit takes them for smaller: with the
// fit's matrix M, whose prior of the errors is L, the estimate's error is M^-1 (noise - L errors), hence its covariance
// M^-1 (J^T W J + L V L) M^-1.
Matrix6d covariance_of(const NormalEquations& equations, const SensorField& field, const StepContext& context) {
    const SensorModel& sensor = context.observation.sensor();
    const Eigen::Index unknowns = field.num_unknowns();
    const Eigen::VectorXd fitted = fitted_variances(field, sensor).cwiseInverse();
    Eigen::MatrixXd matrix = equations.information;
    matrix.diagonal().tail(unknowns) += fitted;
    add_weak_prior(matrix, context.views.extent().diameter_m());
    Eigen::MatrixXd spread = equations.information;
    spread.diagonal().tail(unknowns) += fitted.cwiseAbs2().cwiseProduct(prior_variances(field, sensor));
    add_weak_prior(spread, context.views.extent().diameter_m());
    const Eigen::MatrixXd gain = matrix.llt().solve(Eigen::MatrixXd::Identity(matrix.rows(), matrix.cols())).topRows(6);
    const Matrix6d covariance = gain * spread * gain.transpose();
    return 0.5 * (covariance + covariance.transpose());
}

}  // namespace

FineFit fit_finely(const Pose& start, const StepContext& context) {
    const SensorModel& sensor = context.observation.sensor();
    const SensorField field = field_over(context.observation.camera(), sensor);
    const Eigen::Index unknowns = field.num_unknowns();
    const Eigen::VectorXd prior = fitted_variances(field, sensor).cwiseInverse();
    Linearisation at{start, Eigen::VectorXd::Zero(unknowns), 0.0};
    NormalEquations equations;
    for (int round = 0; round < kRounds; ++round) {
        // A start that is off by little more than the noise is drawn in from farther at first.
        at.extra_sigma_m = round == 0 ? 2.0 * sensor.systematic_sigma_m : 0.0;
        equations = linearise(at, field, context);
        Eigen::MatrixXd information = equations.information;
        information.diagonal().tail(unknowns) += prior;
        add_weak_prior(information, context.views.extent().diameter_m());
        const Eigen::VectorXd step = information.llt().solve(equations.gradient);
        const Pose moved =
            perturb_about(at.camera_from_object, step.head<6>(), context.views.extent().centre_in_object());
        if (!is_valid(moved)) break;
        at.camera_from_object = moved;
        at.errors = step.tail(unknowns);
    }
    return {at.camera_from_object, covariance_of(equations, field, context), equations.pairs};
}

Matrix6d covariance_at(const Pose& camera_from_object, const StepContext& context) {
    const SensorField field = field_over(context.observation.camera(), context.observation.sensor());
    const Linearisation at{camera_from_object, Eigen::VectorXd::Zero(field.num_unknowns()), 0.0};
    return covariance_of(linearise(at, field, context), field, context);
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
