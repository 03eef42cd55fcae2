#include "core/fine_fit.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/sensor_field.hpp"

namespace nearpose {
namespace {

constexpr int kMaxRounds = 4;
constexpr double kGateSigmas = 5.0;   // a pair farther off than that is not the same surface
constexpr double kHuberSigmas = 2.0;  // beyond it a residual pulls with constant force

// The normal equations of one round over (twist about the centre, unknowns of the field), at the pose and at zero
// errors of the sensor.
struct NormalEquations {
    explicit NormalEquations(Eigen::Index count)
        : sums(Eigen::MatrixXd::Zero(6 + count + 1, 6 + count + 1)), unknowns(count) {}

    Eigen::MatrixXd sums;  // of weight * row * row^T, row = (derivatives, residual)
    Eigen::Index unknowns;
    int pairs = 0;
};

// Neighbouring rays share the field's nodes: their rows are summed up as small matrices first.
class CellSum {
  public:
    static constexpr int kSize = 6 + 5 + 1;  // the pose, the nodes around and the scale, the residual
    using Row = Eigen::Matrix<double, kSize, 1>;

    void add(const SensorField::Row& place, const Row& row, double weight, NormalEquations& equations) {
        if (place.unknowns != unknowns_) flush(equations);
        unknowns_ = place.unknowns;
        const Row weighted = weight * row;
        sum_.noalias() += weighted * row.transpose();
    }
    void flush(NormalEquations& equations) {
        std::array<Eigen::Index, kSize> index{};
        for (int i = 0; i < kSize; ++i)
            index[i] = i < 6 ? i : 6 + (i < kSize - 1 ? unknowns_[i - 6] : equations.unknowns);
        for (int j = 0; j < kSize; ++j)
            for (int i = 0; i < kSize; ++i) equations.sums(index[i], index[j]) += sum_(i, j);
        sum_.setZero();
    }

  private:
    Eigen::Matrix<double, kSize, kSize> sum_ = Eigen::Matrix<double, kSize, kSize>::Zero();
    decltype(SensorField::Row::unknowns) unknowns_{};
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

// The surface measured around a ray: the mean over pixels of its part of the grid that lie on the ray's face.
struct MeasuredAround {
    double residual_m = 0.0;  // along the normal
    int count = 0;
};

// Whether the rays beside one meet the same face.
struct FaceGoesOn {
    bool left = false, right = false, up = false, down = false;
};

FaceGoesOn face_goes_on(const View& view, const std::vector<int>& hit_at, std::size_t k, const PixelGrid& grid) {
    const int index = view.pixels[k], u = index % grid.width, v = index / grid.width;
    const auto same = [&](int other) {
        const int hit = hit_at[other];
        if (hit < 0) return false;
        const Eigen::Vector3f between = view.points_in_object[hit] - view.points_in_object[k];
        constexpr float kSine = 0.05F;
        return std::abs(view.normals_in_object[k].dot(between)) < kSine * between.norm() &&
               std::abs(view.normals_in_object[hit].dot(between)) < kSine * between.norm();
    };
    return {u > 0 && same(index - 1), u + 1 < grid.width && same(index + 1), v > 0 && same(index - grid.width),
            v + 1 < grid.height && same(index + grid.width)};
}

// A plane's inverse depth is affine over the image, so that one cast ray speaks for the pixels around: the noise of
// many is averaged for the price of one. Where the face ends or bends the gate leaves pixels out.
struct FaceInImage {
    double inverse_depth, along_u, along_v;  // [1/m], and per pixel
    double slope_by_inverse;                 // normal . (point - camera): the slope of a ray is this times 1 / depth

    MeasuredAround compare(const Observation& observation, int u, int v, int reach, const FaceGoesOn& goes_on,
                           double expected_m, double gate_m) const {
        const PinholeCamera& camera = observation.camera();
        MeasuredAround sum;
        const int step = std::max(1, reach);
        for (int dv = goes_on.up ? -reach : 0; dv <= (goes_on.down ? reach : 0); dv += step) {
            for (int du = goes_on.left ? -reach : 0; du <= (goes_on.right ? reach : 0); du += step) {
                const int other_u = u + du, other_v = v + dv;
                if (other_u < 0 || other_v < 0 || other_u >= camera.width || other_v >= camera.height) continue;
                const int pixel = other_v * camera.width + other_u;
                if (observation.states()[pixel] != PixelState::kCandidate) continue;
                // (measured - model) * slope, with slope = slope_by_inverse / model
                const double inverse = inverse_depth + along_u * du + along_v * dv;
                const double residual_m = (observation.depth_m()[pixel] * inverse - 1.0) * slope_by_inverse;
                if (!(std::abs(residual_m - expected_m) <= gate_m)) continue;
                sum.residual_m += residual_m;
                ++sum.count;
            }
        }
        if (sum.count > 0) sum.residual_m /= sum.count;
        return sum;
    }
};

// The rays keep the faces that they met in `view`, which was cast at a pose near by.
NormalEquations linearise(const Linearisation& at, const View& view, const SensorField& field,
                          const StepContext& context) {
    const ObservedGrid& observed = context.observed;
    const SensorModel& sensor = context.observation.sensor();
    const Eigen::Vector3d centre = context.views.extent().centre_in_object();
    const Eigen::Matrix3d rotation = at.camera_from_object.rotation_matrix();
    const Eigen::Matrix3d object_from_camera = rotation.transpose();
    const Eigen::Vector3d camera_in_object = -(object_from_camera * at.camera_from_object.translation);
    const double fine_m2 = sensor.systematic_fine_sigma_m * sensor.systematic_fine_sigma_m;
    const double shared = rays_per_fine_error(sensor, observed.grid.stride);
    const double field_m2 = sensor.systematic_sigma_m * sensor.systematic_sigma_m;
    NormalEquations equations(field.num_unknowns());
    CellSum cell;
    const PinholeCamera& camera = context.observation.camera();
    const int reach = observed.grid.stride * 2 / 5;
    std::vector<int> hit_at(static_cast<std::size_t>(observed.grid.size()), -1);
    for (std::size_t k = 0; k < view.size(); ++k) hit_at[view.pixels[k]] = static_cast<int>(k);
    for (std::size_t k = 0; k < view.size(); ++k) {
        const int index = view.pixels[k];
        if (observed.states[index] != PixelState::kCandidate) continue;
        const Eigen::Vector3d normal = view.normals_in_object[k].cast<double>();
        const Eigen::Vector3d normal_in_camera = rotation * normal;
        const int u = observed.grid.image_u(index), v = observed.grid.image_v(index);
        const double slope = normal_in_camera.dot(camera.ray(u, v));  // metres along the normal per metre of depth
        const double offset_m = normal.dot(view.points_in_object[k].cast<double>() - camera_in_object);
        const double model_m = offset_m / slope;
        if (!(model_m > 0.0 && slope < 0.0)) continue;  // the face is seen from behind by now, or on edge
        const double measured_m = observed.depth_m[index];
        const SensorField::Row place = field.row_at(u, v, measured_m);
        double known_m = 0.0;
        for (int i = 0; i < 5; ++i) known_m += place.factors[i] * at.errors[place.unknowns[i]];
        const double squared_slope = slope * slope;
        const double noise_m2 =
            sensor.variance_along_normal_m2(observed.sigma_m[index], measured_m, normal_in_camera.z(), camera.fx);
        const double extra_m2 = fine_m2 * squared_slope + at.extra_sigma_m * at.extra_sigma_m;
        const double gate_m = kGateSigmas * std::sqrt(noise_m2 + extra_m2 + field_m2 * squared_slope);
        const FaceInImage face{1.0 / model_m, normal_in_camera.x() / (camera.fx * offset_m),
                               normal_in_camera.y() / (camera.fy * offset_m), offset_m};
        const MeasuredAround measured = face.compare(
            context.observation, u, v, reach, face_goes_on(view, hit_at, k, observed.grid), slope * known_m, gate_m);
        if (measured.count == 0) continue;
        const double sigma_m2 = noise_m2 / measured.count + extra_m2;
        const double off_m = std::abs(measured.residual_m - slope * known_m);
        const double robust = std::min(1.0, kHuberSigmas * std::sqrt(sigma_m2) / std::max(off_m, 1e-12));
        CellSum::Row row;
        row << (camera_in_object + model_m * (object_from_camera * camera.ray(u, v)) - centre).cross(normal), normal,
            slope * Eigen::Map<const Eigen::Matrix<double, 5, 1>>(place.factors.data()), measured.residual_m;
        cell.add(place, row, robust / (sigma_m2 + (shared - 1.0) * fine_m2 * squared_slope), equations);
        ++equations.pairs;
    }
    cell.flush(equations);
    return equations;
}

View cast(const Pose& camera_from_object, const StepContext& context) {
    return context.views.generate(camera_from_object, context.observed.camera);
}

// What is solved: the pose and those of the field's unknowns that some ray met; of the others nothing is learned.
struct Problem {
    std::vector<Eigen::Index> active;  // of the pose and the unknowns
    Eigen::MatrixXd information;       // of the rays, over the active ones
    Eigen::VectorXd gradient;
    Eigen::VectorXd variances;         // of the active unknowns
    Eigen::VectorXd fitted_variances;  // with which they take part in the fit
};

Problem problem_of(const NormalEquations& equations, const SensorField& field, const StepContext& context) {
    const SensorModel& sensor = context.observation.sensor();
    SensorModel fitted = sensor;
    fitted.systematic_sigma_m *= sensor.systematic_fitted;
    fitted.depth_scale_sigma *= sensor.scale_fitted;
    Problem problem;
    for (Eigen::Index i = 0; i < 6 + equations.unknowns; ++i)
        if (i < 6 || equations.sums(i, i) > 0.0) problem.active.push_back(i);
    problem.information = equations.sums(problem.active, problem.active);
    problem.gradient = equations.sums(problem.active, 6 + equations.unknowns);
    const double diameter_m = context.views.extent().diameter_m();  // a weak prior of the pose
    problem.information.diagonal().head<3>().array() += 1.0;
    problem.information.diagonal().segment<3>(3).array() += 1.0 / (diameter_m * diameter_m);
    const auto unknowns = static_cast<Eigen::Index>(problem.active.size()) - 6;
    // An image that is far noisier than the sensor's model is no better in what its pixels share.
    constexpr double kUsual = 1.5;  // up to which the model may be off in its noise alone
    const double worse = std::max(1.0, context.observation.noise_factor() / kUsual);
    const Eigen::VectorXd all = worse * worse * prior_variances(field, sensor);
    const Eigen::VectorXd all_fitted = prior_variances(field, fitted);
    problem.variances.resize(unknowns);
    problem.fitted_variances.resize(unknowns);
    for (Eigen::Index i = 0; i < unknowns; ++i) {
        problem.variances[i] = all[problem.active[i + 6] - 6];
        problem.fitted_variances[i] = all_fitted[problem.active[i + 6] - 6];
    }
    return problem;
}

Eigen::LLT<Eigen::MatrixXd> factor_of(const Problem& problem) {
    Eigen::MatrixXd matrix = problem.information;
    matrix.diagonal().tail(problem.fitted_variances.size()) += problem.fitted_variances.cwiseInverse();
    return matrix.llt();
}

// Of the fit's pose when the sensor's errors have their whole variances, while the fit takes them for smaller: with the
// fit's matrix M, whose prior of the errors is L, the estimate's error is M^-1 (noise - L errors), hence its covariance
// M^-1 (J^T W J + L V L) M^-1.
Matrix6d covariance_of(const Problem& problem, const Eigen::LLT<Eigen::MatrixXd>& factor) {
    Eigen::MatrixXd spread = problem.information;
    spread.diagonal().tail(problem.variances.size()) +=
        problem.fitted_variances.cwiseAbs2().cwiseInverse().cwiseProduct(problem.variances);
    const Eigen::MatrixXd gain = factor.solve(Eigen::MatrixXd::Identity(spread.rows(), 6));
    const Matrix6d covariance = gain.transpose() * (spread * gain);
    return 0.5 * (covariance + covariance.transpose());
}

}  // namespace

FineFit fit_finely(const Pose& start, const StepContext& context) {
    const SensorModel& sensor = context.observation.sensor();
    const SensorField field = field_over(context.observation.camera(), sensor);
    const ModelExtent& extent = context.views.extent();
    const double sigma_m = context.observation.sigma_m(context.observation.mean_distance_m());
    // Of any of the model's points: less than the first is nothing, less than the second meets the same faces.
    const double nothing_m = 0.05 * sigma_m, same_faces_m = 0.5 * sigma_m;
    Linearisation at{start, Eigen::VectorXd::Zero(field.num_unknowns()), 0.0};
    FineFit fit;
    View view = cast(start, context);
    for (int round = 0; round < kMaxRounds; ++round) {
        // A start that is off by little more than the noise is drawn in from farther at first.
        at.extra_sigma_m = round == 0 ? 2.0 * sensor.systematic_sigma_m : 0.0;
        const NormalEquations equations = linearise(at, view, field, context);
        const Problem problem = problem_of(equations, field, context);
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
        if (last) fit.covariance = covariance_of(problem, factor);
        fit.pairs = equations.pairs;
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
        problem_of(linearise(at, cast(camera_from_object, context), field, context), field, context);
    return covariance_of(problem, factor_of(problem));
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
