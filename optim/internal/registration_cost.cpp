#include "optim/internal/registration_cost.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>

namespace nearpose {
namespace {

using Lanes = NormalisedPairs::Lanes;
using Lanes3 = NormalisedPairs::Lanes3;
using Lanes6 = Eigen::Array<double, NormalisedPairs::kLanes, 6>;

// A loss rho and its derivative at the squared residual s = |e|^2, of four pairs. The robust residual is f e with
// f = sqrt(rho / s), and its derivative (f I + (rho' / f - f) / s e e^T) de. In the sums this gives J^T J the weight
// rho / s across e and `along` along e, and the gradient rho' J^T e; no root has to be taken.
struct LossLanes {
    Lanes rho_over_s = Lanes::Ones();
    Lanes rho_derivative = Lanes::Ones();
    Lanes along() const { return rho_derivative.square() / rho_over_s; }
};

inline LossLanes loss_lanes(RobustLoss loss, double scale_sigmas, const Lanes& s) {
    LossLanes result;
    if (loss == RobustLoss::kNone) return result;
    const Lanes u = s * (1.0 / (scale_sigmas * scale_sigmas));
    if (loss == RobustLoss::kHuber) {
        const Lanes root = u.max(1.0).sqrt().inverse();
        result.rho_over_s = (2.0 - root) * root;
        result.rho_derivative = root;
    } else if (loss == RobustLoss::kCauchy) {
        for (int lane = 0; lane < NormalisedPairs::kLanes; ++lane) {
            if (u[lane] > 0.0) result.rho_over_s[lane] = std::log1p(u[lane]) / u[lane];
        }
        result.rho_derivative = (1.0 + u).inverse();
    } else {
        const Lanes inside = u.min(1.0);
        // Equal to 1 - u + u^2 / 3 inside; beyond, the constant 1/3 divided by u.
        result.rho_over_s = (1.0 - inside + inside.square() / 3.0) / u.max(1.0);
        result.rho_derivative = (1.0 - inside).square();
    }
    return result;
}

// Lower triangle of the sum of weight * row * row^T.
struct OuterProducts {
    Lanes sums[21];
    OuterProducts() {
        for (Lanes& sum : sums) sum.setZero();
    }
    inline void add(const Lanes6& row, const Lanes& weight) {
        int k = 0;
#pragma GCC unroll 6
        for (int i = 0; i < 6; ++i) {
            const Lanes weighted = weight * row.col(i);
#pragma GCC unroll 6
            for (int j = 0; j <= i; ++j) sums[k++] += weighted * row.col(j);
        }
    }
    Matrix6d total() const {
        Matrix6d matrix;
        int k = 0;
        for (int i = 0; i < 6; ++i) {
            for (int j = 0; j <= i; ++j) matrix(i, j) = matrix(j, i) = sums[k++].sum();
        }
        return matrix;
    }
};

inline Lanes3 cross(const Lanes3& a, const Lanes3& b) {
    Lanes3 product;
    product.col(0) = a.col(1) * b.col(2) - a.col(2) * b.col(1);
    product.col(1) = a.col(2) * b.col(0) - a.col(0) * b.col(2);
    product.col(2) = a.col(0) * b.col(1) - a.col(1) * b.col(0);
    return product;
}

// T^-1 q, the measured points in the object's frame.
inline Lanes3 measured_in_object(const NormalisedPairs::Block& block, const Eigen::Matrix3d& rotation,
                                 const Eigen::Vector3d& translation) {
    const Lanes x = block.point_in_camera.col(0) - translation[0];
    const Lanes y = block.point_in_camera.col(1) - translation[1];
    const Lanes z = block.point_in_camera.col(2) - translation[2];
    Lanes3 result;
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) result.col(i) = x * rotation(0, i) + y * rotation(1, i) + z * rotation(2, i);
    return result;
}

// e = n . (p - T^-1 q) / sigma, which is (R n) . (T p - q) / sigma. A right perturbation (w, v) of T moves T^-1 q by
// -(w x T^-1 q + v), so de = (T^-1 q x n) . w + n . v.
RegistrationEquations plane_equations(const NormalisedPairs& pairs, const Pose& pose, const RobustResidual& residual) {
    const Eigen::Matrix3d rotation = pose.rotation_matrix();
    OuterProducts products;
    Lanes6 gradient = Lanes6::Zero();
    Lanes cost = Lanes::Zero();
    for (const NormalisedPairs::Block& block : pairs.blocks) {
        const Lanes3 measured = measured_in_object(block, rotation, pose.translation);
        const Lanes3& normal = block.weighted_normal;
        const Lanes3 difference = block.point_in_object - measured;
        const Lanes e =
            difference.col(0) * normal.col(0) + difference.col(1) * normal.col(1) + difference.col(2) * normal.col(2);
        const Lanes s = e.square();
        const LossLanes rho = loss_lanes(residual.loss, residual.loss_scale_sigmas, s);
        Lanes6 row;
        row.leftCols<3>() = cross(measured, normal);
        row.rightCols<3>() = normal;
        products.add(row, rho.along());
        const Lanes pull = rho.rho_derivative * e;
#pragma GCC unroll 6
        for (int i = 0; i < 6; ++i) gradient.col(i) += pull * row.col(i);
        cost += rho.rho_over_s * s;
    }
    return {products.total(), gradient.colwise().sum().transpose().matrix(), cost.sum()};
}

// The sum of weight * (-[p]x, I)^T (-[p]x, I), from the sums of weight * (p p^T, p, 1).
Matrix6d turns_and_shifts(const Lanes (&moments)[10]) {
    const double xx = moments[0].sum(), yx = moments[1].sum(), yy = moments[2].sum();
    const double zx = moments[3].sum(), zy = moments[4].sum(), zz = moments[5].sum();
    const double x = moments[6].sum(), y = moments[7].sum(), z = moments[8].sum();
    Eigen::Matrix3d turn, coupling;
    turn << yy + zz, -yx, -zx, -yx, xx + zz, -zy, -zx, -zy, xx + yy;
    coupling << 0.0, -z, y, z, 0.0, -x, -y, x, 0.0;
    Matrix6d matrix;
    matrix << turn, coupling, coupling.transpose(), moments[9].sum() * Eigen::Matrix3d::Identity();
    return matrix;
}

// e = (T p - q) / sigma with J = R (-[p]x, I) / sigma. R drops out of J^T J, and of J^T e if e is turned into the
// object's frame, d = p - T^-1 q.
RegistrationEquations point_equations(const NormalisedPairs& pairs, const Pose& pose, const RobustResidual& residual) {
    const Eigen::Matrix3d rotation = pose.rotation_matrix();
    OuterProducts products;  // what a loss takes away along e
    Lanes moments[10];       // sums of weight * (1, p) (1, p)^T
    for (Lanes& moment : moments) moment.setZero();
    Lanes6 gradient = Lanes6::Zero();
    Lanes cost = Lanes::Zero();
    for (const NormalisedPairs::Block& block : pairs.blocks) {
        const Lanes3& p = block.point_in_object;
        Lanes3 e = p - measured_in_object(block, rotation, pose.translation);
        for (int i = 0; i < 3; ++i) e.col(i) *= block.weight;
        const Lanes s = e.square().rowwise().sum();
        const LossLanes rho = loss_lanes(residual.loss, residual.loss_scale_sigmas, s);
        Lanes6 jte;  // of each pair
        jte.leftCols<3>() = cross(p, e);
        jte.rightCols<3>() = e;
        for (int i = 0; i < 6; ++i) jte.col(i) *= block.weight;

        const Lanes across = rho.rho_over_s * block.weight.square();
        int k = 0;
        for (int i = 0; i < 3; ++i) {
            const Lanes weighted = across * p.col(i);
            for (int j = 0; j <= i; ++j) moments[k++] += weighted * p.col(j);
        }
        for (int i = 0; i < 3; ++i) moments[6 + i] += across * p.col(i);
        moments[9] += across;
        if (residual.loss != RobustLoss::kNone) {
            products.add(jte, (s > 0.0).select((rho.along() - rho.rho_over_s) / s.max(1e-300), 0.0));
        }
        for (int i = 0; i < 6; ++i) gradient.col(i) += rho.rho_derivative * jte.col(i);
        cost += rho.rho_over_s * s;
    }
    RegistrationEquations sums{products.total(), gradient.colwise().sum().transpose().matrix(), cost.sum()};
    sums.jtj += turns_and_shifts(moments);
    return sums;
}

// Six rows J' and seven residuals r', the seventh with a zero row, with the given sums.
Matrix6d factorise(const RegistrationEquations& sums, Eigen::Map<Eigen::Matrix<double, 7, 1>>& r) {
    // J^T J = P^T L D L^T P, hence the rows D^1/2 L^T P. Where the pairs leave a direction open, D ends in zero (or the
    // rounding of it), and that row stays zero.
    const Eigen::LDLT<Matrix6d> factors(sums.jtj);
    const Twist d = factors.vectorD();
    const Twist explained = factors.matrixL().solve(factors.transpositionsP() * sums.jtr);
    const Matrix6d permutation = factors.transpositionsP() * Matrix6d::Identity();
    Matrix6d rows = Matrix6d(factors.matrixU()) * permutation;
    for (int k = 0; k < 6; ++k) {
        const double root = d[k] > 1e-13 * d[0] ? std::sqrt(d[k]) : 0.0;
        rows.row(k) *= root;
        if (root > 0.0) r[k] = explained[k] / root;
    }
    const double rest = sums.rtr - r.squaredNorm();
    if (rest > 0.0) {
        r[6] = std::sqrt(rest);
    } else if (r.squaredNorm() > 0.0) {
        r *= std::sqrt(sums.rtr / r.squaredNorm());  // rounding only; the cost is what steps are judged by
    }
    return rows;
}

}  // namespace

RegistrationEquations registration_equations(const NormalisedPairs& pairs, const Pose& normalised_pose,
                                             const RobustResidual& residual) {
    return residual.kind == ResidualKind::kPointToPlane ? plane_equations(pairs, normalised_pose, residual)
                                                        : point_equations(pairs, normalised_pose, residual);
}

bool is_finite(const RegistrationEquations& sums) {
    return std::isfinite(sums.rtr) && sums.jtr.allFinite() && sums.jtj.allFinite();
}

RegistrationCost::RegistrationCost(const NormalisedPairs& pairs, const RobustResidual& residual,
                                   const Pose& normalised_start)
    : pairs_(pairs), residual_(residual), start_(normalised_start) {
    latest_parameters_.setConstant(std::numeric_limits<double>::quiet_NaN());  // equal to none
}

Pose RegistrationCost::pose_at(const double* turn_and_shift) const {
    const Eigen::Map<const Twist> x(turn_and_shift);
    Twist turn = Twist::Zero();
    turn.head<3>() = x.head<3>();
    const Eigen::Quaterniond rotation = (start_.rotation * exp(turn).rotation).normalized();
    return {rotation, start_.translation + start_.rotation * x.tail<3>()};
}

const RegistrationEquations& RegistrationCost::sums_at(const Twist& turn_and_shift) const {
    if (turn_and_shift != latest_parameters_) {
        latest_ = registration_equations(pairs_, pose_at(turn_and_shift.data()), residual_);
        latest_parameters_ = turn_and_shift;
    }
    return latest_;
}

namespace {

// The right Jacobian of SO(3): exp(w + d) = exp(w) exp(J d) for small d.
Eigen::Matrix3d right_jacobian(const Eigen::Vector3d& w) {
    const double angle_squared = w.squaredNorm();
    constexpr double kTiny = 1e-8;  // beyond the series' first terms nothing is left
    const double angle = std::sqrt(angle_squared);
    const double a = angle_squared < kTiny ? 0.5 : (1.0 - std::cos(angle)) / angle_squared;
    const double b = angle_squared < kTiny ? 1.0 / 6.0 : (angle - std::sin(angle)) / (angle_squared * angle);
    return Eigen::Matrix3d::Identity() - a * skew(w) + b * skew(w) * skew(w);
}

}  // namespace

bool RegistrationCost::operator()(const double* turn_and_shift, double* residuals, double* jacobian) const {
    const Eigen::Map<const Twist> x(turn_and_shift);
    Eigen::Map<Eigen::Matrix<double, NUM_RESIDUALS, 1>> r(residuals);
    const RegistrationEquations& sums = sums_at(x);
    if (!is_finite(sums)) {
        constexpr double kUnreachable = 1e100;
        r.setConstant(kUnreachable);
        return false;
    }
    r.setZero();
    if (jacobian != nullptr) linearised_at_ = x;
    r.tail<6>() = stay_ * (x - linearised_at_);
    if (jacobian == nullptr) {
        r[6] = std::sqrt(sums.rtr);
        return true;
    }
    Eigen::Map<Eigen::Matrix<double, 7, 1>> of_pairs(residuals);
    const Matrix6d rows = factorise(sums, of_pairs);
    // The rows are derivatives by a perturbation on the right, pose * exp(d); the parameters' change moves it by
    // (J dw, exp(-w) dv).
    Eigen::Map<Eigen::Matrix<double, NUM_RESIDUALS, 6>> by_parameters(jacobian);
    by_parameters.setZero();
    const Eigen::Matrix3d turn_back =
        (pose_at(turn_and_shift).rotation.conjugate() * start_.rotation).toRotationMatrix();
    by_parameters.topLeftCorner<6, 3>().noalias() = rows.leftCols<3>() * right_jacobian(x.head<3>());
    by_parameters.topRightCorner<6, 3>().noalias() = rows.rightCols<3>() * turn_back;
    by_parameters.bottomRows<6>().diagonal().setConstant(stay_);
    return true;
}

}  // namespace nearpose
