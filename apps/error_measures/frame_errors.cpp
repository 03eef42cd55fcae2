#include "apps/error_measures/frame_errors.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace nearpose::evaluation {
namespace {

using Corners = std::array<Eigen::Vector3d, 8>;

Corners box_corners(const data_set::ModelInfo& model) {
    Corners corners;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const Eigen::Vector3d& low = model.box_min_in_object_m;
        const Eigen::Vector3d& high = model.box_max_in_object_m;
        corners[i] = {(i & 1U ? high : low).x(), (i & 2U ? high : low).y(), (i & 4U ? high : low).z()};
    }
    return corners;
}

double largest_distance_m(const Corners& corners, const Pose& a, const Pose& b) {
    double largest = 0.0;
    for (const Eigen::Vector3d& corner : corners) largest = std::max(largest, (a * corner - b * corner).norm());
    return largest;
}

// The true pose, turned about the axis to where it is nearest to `estimate`: the best of some samples, then golden
// sections around it.
Pose nearest_turn(const AxisOfRevolution& symmetry, const Corners& corners, const Pose& estimate, const Pose& truth) {
    constexpr int kSamples = 360;
    constexpr int kSections = 60;
    constexpr double kStep_rad = 2.0 * std::numbers::pi / kSamples;
    const auto cost = [&](double angle_rad) {
        return largest_distance_m(corners, estimate, truth * turn_about(symmetry, angle_rad));
    };
    int best = 0;
    double least_m = cost(0.0);
    for (int i = 1; i < kSamples; ++i) {
        const double cost_m = cost(i * kStep_rad);
        if (cost_m < least_m) {
            best = i;
            least_m = cost_m;
        }
    }
    double low = (best - 1) * kStep_rad, high = (best + 1) * kStep_rad;
    const double golden = 1.0 / std::numbers::phi;
    for (int i = 0; i < kSections; ++i) {
        const double left = high - golden * (high - low), right = low + golden * (high - low);
        if (cost(left) < cost(right)) {
            high = right;
        } else {
            low = left;
        }
    }
    return truth * turn_about(symmetry, 0.5 * (low + high));
}

// Sum of the distances of `a`'s points from those of `b`, by index, over their number.
double mean_distance_m(const std::vector<Eigen::Vector3d>& a, const std::vector<Eigen::Vector3d>& b) {
    double sum_m = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) sum_m += (a[i] - b[i]).norm();
    return sum_m / static_cast<double>(a.size());
}

std::vector<Eigen::Vector3d> moved(const Pose& pose, const std::vector<Eigen::Vector3d>& points) {
    const Eigen::Matrix3d rotation = pose.rotation_matrix();
    std::vector<Eigen::Vector3d> result;
    result.reserve(points.size());
    for (const Eigen::Vector3d& point : points) result.emplace_back(rotation * point + pose.translation);
    return result;
}

// From each vertex in the true pose to the nearest in the estimated one. Both are looked at from the estimated object,
// where one index serves all poses. It is of floats: it may take a vertex that is farther by their rounding (1e-5 mm)
// than the nearest, which happens to about as small a share of the vertices; the distances are those of doubles.
double add_s_m(const Pose& estimate, const Pose& truth, const ModelShape& shape) {
    const std::vector<Eigen::Vector3d> seen = moved(estimate.inverse() * truth, shape.vertices_in_object_m);
    std::vector<Eigen::Vector3f> queries;
    queries.reserve(seen.size());
    for (const Eigen::Vector3d& point : seen) {
        // Beyond, where the squares of floats end, all vertices are as far.
        constexpr double kFar_m = 1e6;
        queries.emplace_back(point.norm() < kFar_m ? Eigen::Vector3f(point.cast<float>())
                                                   : Eigen::Vector3f(0.0F, 0.0F, 0.0F));
    }
    const std::vector<PointIndex::Neighbour> nearest = shape.vertex_index->nearest(queries);
    double sum_m = 0.0;
    for (std::size_t i = 0; i < seen.size(); ++i) {
        sum_m += (seen[i] - shape.vertices_in_object_m[static_cast<std::size_t>(nearest[i].index)]).norm();
    }
    return sum_m / static_cast<double>(seen.size());
}

// The least over `symmetries` of the largest distance of two places of a vertex, where `place` says where one is.
template <typename Place>
double least_largest(const std::vector<Eigen::Vector3d>& vertices, const std::vector<Pose>& symmetries,
                     const Pose& estimate, const Pose& truth, const Place& place) {
    using Where = decltype(place(vertices.front()));
    std::vector<Where> estimated;
    estimated.reserve(vertices.size());
    for (const Eigen::Vector3d& point : moved(estimate, vertices)) estimated.push_back(place(point));
    double least = std::numeric_limits<double>::infinity();
    std::size_t farthest = 0;
    for (const Pose& symmetry : symmetries) {
        const Pose equal = truth * symmetry;
        const Eigen::Matrix3d rotation = equal.rotation_matrix();
        const auto squared = [&](std::size_t i) {
            return (estimated[i] - place(rotation * vertices[i] + equal.translation)).squaredNorm();
        };
        // Most symmetries are out at once: the vertex that decided last time is asked first.
        double largest = squared(farthest);
        for (std::size_t i = 0; i < vertices.size() && largest < least; ++i) {
            const double value = squared(i);
            if (value > largest) farthest = i;
            largest = std::max(largest, value);
        }
        least = std::min(least, largest);
    }
    return std::sqrt(least);
}

// difference^T covariance^-1 difference; nothing where the covariance is not positive definite.
std::optional<double> squared_distance(const Eigen::VectorXd& difference, const Eigen::MatrixXd& covariance) {
    if (!covariance.allFinite() || !(covariance.diagonal().minCoeff() > 0.0)) return std::nullopt;
    // In units of the standard deviations: radians and metres differ by orders of magnitude.
    const Eigen::VectorXd scale = covariance.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::LDLT<Eigen::MatrixXd> factors(scale.asDiagonal() * covariance * scale.asDiagonal());
    constexpr double kLeastPivot = 1e-12;
    if (factors.info() != Eigen::Success || !(factors.vectorD().minCoeff() > kLeastPivot)) return std::nullopt;
    const Eigen::VectorXd scaled = scale.cwiseProduct(difference);
    return scaled.dot(factors.solve(scaled));
}

void add_mahalanobis(const EstimatedFrame& estimate, const Pose& truth, PoseErrors& errors) {
    if (!estimate.covariance) return;
    const Twist difference = log(estimate.camera_from_object.inverse() * truth);
    const Matrix6d& covariance = *estimate.covariance;
    errors.mahalanobis_squared = squared_distance(difference, covariance);
    errors.mahalanobis_rotation_squared = squared_distance(difference.head<3>(), covariance.topLeftCorner<3, 3>());
    errors.mahalanobis_translation_squared =
        squared_distance(difference.tail<3>(), covariance.bottomRightCorner<3, 3>());
}

PoseErrors errors_towards(const Pose& estimate, const Pose& nearest, const data_set::ModelInfo& model) {
    const Eigen::Vector3d centre_in_object = 0.5 * (model.box_min_in_object_m + model.box_max_in_object_m);
    PoseErrors errors;
    errors.translation_in_camera_m = estimate * centre_in_object - nearest * centre_in_object;
    const Pose turn{(estimate.rotation * nearest.rotation.conjugate()).normalized(), Eigen::Vector3d::Zero()};
    errors.rotation_in_camera_rad = log(turn).head<3>();
    errors.translation_m = errors.translation_in_camera_m.norm();
    errors.rotation_rad = errors.rotation_in_camera_rad.norm();
    return errors;
}

}  // namespace

Pose nearest_equivalent(const Pose& estimate, const Pose& truth, const data_set::ModelInfo& model) {
    const Corners corners = box_corners(model);
    Pose nearest = truth;
    double least_m = std::numeric_limits<double>::infinity();
    const auto consider = [&](const Pose& pose) {
        const double distance_m = largest_distance_m(corners, estimate, pose);
        if (distance_m < least_m) nearest = pose;
        least_m = std::min(least_m, distance_m);
    };
    std::vector<Pose> equals = {truth};
    for (const Pose& symmetry : model.discrete_symmetries) equals.push_back(truth * symmetry);
    for (const Pose& pose : equals) {
        consider(pose);
        for (const AxisOfRevolution& symmetry : model.continuous_symmetries) {
            consider(nearest_turn(symmetry, corners, estimate, pose));
        }
    }
    return nearest;
}

PoseErrors pose_error(const Pose& estimate, const Pose& truth, const data_set::ModelInfo& model) {
    return errors_towards(estimate, nearest_equivalent(estimate, truth, model), model);
}

FrameErrors frame_errors(const TrueFrame& truth, const std::optional<EstimatedFrame>& estimate, const ModelShape& shape,
                         const PinholeCamera& camera) {
    FrameErrors frame;
    frame.frame_id = truth.frame_id;
    frame.visibility = truth.visibility;
    frame.shown = truth.shown;
    frame.part_moved = truth.part_moved;
    frame.after_fault = truth.after_fault;
    if (!estimate) return frame;
    frame.score = estimate->score;
    frame.time_s = estimate->time_s;
    frame.predicted = estimate->predicted;
    frame.verdict = estimate->verdict;

    const Pose& estimated = estimate->camera_from_object;
    const Pose nearest = nearest_equivalent(estimated, truth.camera_from_object, shape.info);
    PoseErrors& errors = frame.errors.emplace(errors_towards(estimated, nearest, shape.info));
    const std::vector<Eigen::Vector3d>& vertices = shape.vertices_in_object_m;
    errors.add_m = mean_distance_m(moved(estimated, vertices), moved(truth.camera_from_object, vertices));
    errors.add_s_m = add_s_m(estimated, truth.camera_from_object, shape);
    errors.mssd_m = least_largest(vertices, shape.symmetries, estimated, truth.camera_from_object,
                                  [](const Eigen::Vector3d& point) { return point; });
    errors.mspd_px = least_largest(vertices, shape.symmetries, estimated, truth.camera_from_object,
                                   [&](const Eigen::Vector3d& point) { return camera.project(point); });
    add_mahalanobis(*estimate, nearest, errors);
    return frame;
}

}  // namespace nearpose::evaluation
