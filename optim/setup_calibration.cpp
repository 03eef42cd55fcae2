#include "optim/setup_calibration.hpp"

#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "core/base/check.hpp"

namespace nearpose {
namespace {

constexpr double kMedianChiSquare6 = 5.348;

template <class T>
using Vector3 = Eigen::Matrix<T, 3, 1>;

// A rigid transform of automatically differentiated numbers.
template <class T>
struct Rigid {
    Eigen::Quaternion<T> rotation;
    Vector3<T> translation;
};

template <class T>
Rigid<T> operator*(const Rigid<T>& a, const Rigid<T>& b) {
    return {a.rotation * b.rotation, a.rotation * b.translation + a.translation};
}

template <class T>
Rigid<T> cast(const Pose& pose) {
    return {pose.rotation.cast<T>(), pose.translation.cast<T>()};
}

template <class T>
Eigen::Quaternion<T> turn_by(const Vector3<T>& angle_axis) {
    T wxyz[4];
    ceres::AngleAxisToQuaternion(angle_axis.data(), wxyz);
    return Eigen::Quaternion<T>(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
}

template <class T>
Vector3<T> angle_axis_of(const Eigen::Quaternion<T>& turn) {
    const T wxyz[4] = {turn.w(), turn.x(), turn.y(), turn.z()};
    Vector3<T> angle_axis;
    ceres::QuaternionToAngleAxis(wxyz, angle_axis.data());
    return angle_axis;
}

// Turned and shifted about the model's centre, in object axes: perturb_about.
template <class T>
Rigid<T> perturbed(const Rigid<T>& pose, const Vector3<T>& turn, const Vector3<T>& shift, const Vector3<T>& centre) {
    const Eigen::Quaternion<T> rotation = turn_by(turn);
    return pose * Rigid<T>{rotation, centre - rotation * centre + shift};
}

// The motion of a frame, times a factor: exp(factor * twist) to the second order of the motion.
template <class T>
Rigid<T> part_of_motion(const Twist& twist, const T& factor) {
    const Vector3<T> turn = twist.head<3>().cast<T>() * factor;
    const Vector3<T> shift = twist.tail<3>().cast<T>() * factor;
    return {turn_by(turn), shift + T(0.5) * turn.cross(shift)};
}

// The six whitened numbers by which a sighting misses the part's place.
class SightingCost {
  public:
    SightingCost(const Sighting& sighting, const Pose& start, const Eigen::Vector3d& centre, double errors_shared_by)
        : sighting_(sighting), start_(start), centre_(centre) {
        const Eigen::LLT<Matrix6d> factor(sighting.covariance * errors_shared_by);
        whitening_ = factor.matrixL().solve(Matrix6d::Identity());
    }

    // `place`: a twist from the start; `setup`: a SetupVector.
    template <class T>
    bool operator()(const T* place, const T* setup, T* residual) const {
        using Map3 = Eigen::Map<const Vector3<T>>;
        const Vector3<T> centre = centre_.cast<T>();
        const Eigen::Matrix<T, 6, 1> off =
            -(sighting_.setup_effect.cast<T>() * Eigen::Map<const Eigen::Matrix<T, kSetupErrors, 1>>(setup));
        const Rigid<T> camera_from_object =
            perturbed<T>(cast<T>(sighting_.camera_from_object), off.template head<3>(), off.template tail<3>(), centre);
        const Rigid<T> given_from_camera{turn_by<T>(Map3(setup + kHandEyeTurn)), Map3(setup + kHandEyeShift)};
        const Rigid<T> arm_from_given =
            cast<T>(sighting_.arm_from_camera) * part_of_motion<T>(sighting_.camera_motion, -setup[kTimeOffset]);
        const Rigid<T> seen = arm_from_given * given_from_camera * camera_from_object;
        const Rigid<T> stands = perturbed<T>(cast<T>(start_), Map3(place), Map3(place + 3), centre);
        const Eigen::Quaternion<T> back = stands.rotation.conjugate();
        Eigen::Matrix<T, 6, 1> twist;
        twist.template head<3>() = angle_axis_of<T>(back * seen.rotation);
        twist.template tail<3>() = back * Vector3<T>(seen.rotation * centre + seen.translation -
                                                     stands.rotation * centre - stands.translation);
        Eigen::Map<Eigen::Matrix<T, 6, 1>> whitened(residual);
        whitened = whitening_.cast<T>() * twist;
        return true;
    }

  private:
    Sighting sighting_;
    Pose start_;
    Eigen::Vector3d centre_;
    Matrix6d whitening_;
};

class PriorCost {
  public:
    explicit PriorCost(const SetupCalibrationOptions& options)
        : mean_(options.prior_mean), sigma_(options.prior_sigma) {}

    template <class T>
    bool operator()(const T* setup, T* residual) const {
        for (Eigen::Index i = 0; i < kSetupUnknowns; ++i) residual[i] = (setup[i] - T(mean_[i])) / T(sigma_[i]);
        return true;
    }

  private:
    SetupVector mean_, sigma_;
};

// The longest run in which one mode was tracked: in the others the part was taken to lie otherwise.
std::vector<Sighting> of_longest_mode(const std::vector<Sighting>& sightings) {
    auto best = sightings.begin(), best_end = sightings.begin();
    for (auto begin = sightings.begin(); begin != sightings.end();) {
        const auto end = std::find_if(begin + 1, sightings.end(), [](const Sighting& s) { return s.other_mode; });
        if (end - begin >= best_end - best) best = begin, best_end = end;
        begin = end;
    }
    return {best, best_end};
}

// The place of the sighting that most others are near: one that is wrong is no start.
Pose middle_place(const std::vector<Sighting>& sightings, const Eigen::Vector3d& centre) {
    Pose best = sightings.front().arm_from_object();
    double least_m = std::numeric_limits<double>::infinity();
    for (const Sighting& sighting : sightings) {
        const Eigen::Vector3d place = sighting.arm_from_object() * centre;
        double sum_m = 0.0;
        for (const Sighting& other : sightings) sum_m += (other.arm_from_object() * centre - place).norm();
        if (sum_m >= least_m) continue;
        least_m = sum_m;
        best = sighting.arm_from_object();
    }
    return best;
}

// Of the sightings about the solution, by the median of their squared Mahalanobis distances.
double unit_sigma_of(const std::vector<SightingCost>& costs, const Twist& place, const SetupVector& errors) {
    std::vector<double> distances;
    for (const SightingCost& cost : costs) {
        Twist residual;
        cost(place.data(), errors.data(), residual.data());
        distances.push_back(residual.squaredNorm());
    }
    const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
    std::nth_element(distances.begin(), middle, distances.end());
    return std::sqrt(*middle / kMedianChiSquare6);
}

struct Solution {
    double cost = 0.0;
    SetupMatrix covariance;  // of the errors, with all else free
};

// Minimises. Nothing where that fails.
std::optional<Solution> solve(ceres::Problem& problem, const SetupCalibrationOptions& options,
                              const SetupVector& errors) {
    ceres::Solver::Options solver;
    solver.linear_solver_type = ceres::DENSE_QR;
    solver.max_num_iterations = options.max_iterations;
    solver.function_tolerance = 1e-9;
    solver.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(solver, &problem, &summary);
    if (summary.termination_type != ceres::CONVERGENCE || !errors.allFinite()) return std::nullopt;

    ceres::Covariance::Options dense;
    dense.algorithm_type = ceres::DENSE_SVD;
    ceres::Covariance found(dense);
    Solution solution{summary.final_cost, {}};
    if (!found.Compute({std::make_pair<const double*, const double*>(errors.data(), errors.data())}, &problem))
        return std::nullopt;
    // Row by row, which of a symmetric matrix is the same as column by column.
    if (!found.GetCovarianceBlock(errors.data(), errors.data(), solution.covariance.data())) return std::nullopt;
    return solution;
}

// The place's part of the posterior does not depend on the prior of the errors.
double log_evidence_of(const Solution& solution, const SetupVector& prior_sigma) {
    const SetupMatrix in_sigmas =
        prior_sigma.cwiseInverse().asDiagonal() * solution.covariance * prior_sigma.cwiseInverse().asDiagonal();
    const Eigen::LDLT<SetupMatrix> factor(in_sigmas);
    return -solution.cost + 0.5 * factor.vectorD().array().max(1e-300).log().sum();
}

}  // namespace

SetupVector in_order(const SetupSigmas& sigmas) {
    SetupVector vector;
    vector << sigmas.focal_length, Eigen::Vector2d::Constant(sigmas.principal_point_pixels), sigmas.depth_scale,
        Eigen::Vector3d::Constant(sigmas.hand_eye_rad), Eigen::Vector3d::Constant(sigmas.hand_eye_m),
        sigmas.time_offset_frames;
    return vector;
}

void validate(const SetupCalibrationOptions& options) {
    for (Eigen::Index i = 0; i < kSetupUnknowns; ++i) {
        check_option("setup_calibration.prior_mean", options.prior_mean[i], -1e6, 1e6);
        check_option("setup_calibration.prior_sigma", options.prior_sigma[i], 1e-12, 1e6);
    }
    check_option("setup_calibration.sightings_per_error", options.sightings_per_error, 1.0, 1e3);
    check_option("setup_calibration.loss_sigmas", options.loss_sigmas, 0.1, 1e6);
    check_option("setup_calibration.min_sightings", options.min_sightings, 2, 10000);
    check_option("setup_calibration.max_iterations", options.max_iterations, 1, 10000);
}

SetupCalibration calibrate_setup(const std::vector<Sighting>& sightings, const Eigen::Vector3d& centre_in_object,
                                 const SetupCalibrationOptions& options) {
    validate(options);
    SetupCalibration result;
    result.errors = options.prior_mean;
    result.covariance = options.prior_sigma.cwiseAbs2().asDiagonal();
    const std::vector<Sighting> taken = of_longest_mode(sightings);
    result.sightings = static_cast<int>(taken.size());
    if (result.sightings < options.min_sightings) return result;

    const Pose start = middle_place(taken, centre_in_object);
    std::vector<SightingCost> costs;
    for (const Sighting& sighting : taken)
        costs.emplace_back(sighting, start, centre_in_object, options.sightings_per_error);
    Twist place = Twist::Zero();
    SetupVector errors = options.prior_mean;
    ceres::Problem problem;
    for (const SightingCost& cost : costs) {
        problem.AddResidualBlock(
            new ceres::AutoDiffCostFunction<SightingCost, 6, 6, kSetupUnknowns>(new SightingCost(cost)),
            new ceres::CauchyLoss(options.loss_sigmas), place.data(), errors.data());
    }
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<PriorCost, kSetupUnknowns, kSetupUnknowns>(new PriorCost(options)), nullptr,
        errors.data());
    const std::optional<Solution> solution = solve(problem, options, errors);
    if (!solution) return result;
    const SetupMatrix& found = solution->covariance;
    result.log_evidence = log_evidence_of(*solution, options.prior_sigma);
    result.unit_sigma = unit_sigma_of(costs, place, errors);
    result.errors = errors;
    // The prior's share does not grow: no sigma exceeds it.
    const double factor = std::max(1.0, result.unit_sigma);
    const SetupVector room = options.prior_sigma.cwiseQuotient(found.diagonal().cwiseSqrt());
    const SetupVector wider = room.cwiseMin(factor);
    result.covariance = wider.asDiagonal() * found * wider.asDiagonal();
    result.arm_from_object = perturb_about(start, place, centre_in_object);
    result.solved = true;
    return result;
}

}  // namespace nearpose
