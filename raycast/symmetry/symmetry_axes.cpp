#include "raycast/symmetry/symmetry_axes.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

namespace nearpose {
namespace {

struct SurfaceMoments {
    Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
    Eigen::Vector3d moments = Eigen::Vector3d::Zero();   // ascending [m^2]
    Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  // columns
};

template <typename Visit>
void for_each_hit(const ViewsAround& around, const Visit& visit) {
    for (const SeenPixels& seen : around.seen)
        for (std::size_t i = 0; i < seen.points_in_object.size(); ++i)
            if (!seen.normals_in_object[i].isZero()) visit(seen.points_in_object[i], seen.normals_in_object[i]);
}

SurfaceMoments moments_of(const ViewsAround& around) {
    SurfaceMoments result;
    for_each_hit(around, [&](const auto& point, const auto&) { result.centroid += point.template cast<double>(); });
    result.centroid /= around.hits;
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    for_each_hit(around, [&](const auto& point, const auto&) {
        const Eigen::Vector3d arm = point.template cast<double>() - result.centroid;
        covariance += arm * arm.transpose() / around.hits;
    });
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
    result.moments = solver.eigenvalues();
    result.axes = solver.eigenvectors();
    return result;
}

// Outward directions of the model's large faces, the largest first.
std::vector<Eigen::Vector3d> face_directions(const ViewsAround& around, const CandidateAxisOptions& options) {
    constexpr std::size_t kMaxDistinct = 200;  // a curved surface has no end of them
    struct Face {
        Eigen::Vector3f direction;
        int hits;
    };
    std::vector<Face> faces;
    for_each_hit(around, [&](const auto&, const Eigen::Vector3f& normal) {
        for (Face& face : faces) {
            if (face.direction.dot(normal) < options.same_face) continue;
            ++face.hits;
            return;
        }
        if (faces.size() < kMaxDistinct) faces.push_back({normal, 1});
    });
    std::stable_sort(faces.begin(), faces.end(), [](const Face& a, const Face& b) { return a.hits > b.hits; });
    const auto max_faces = static_cast<std::size_t>(options.max_faces);
    std::vector<Eigen::Vector3d> directions;
    for (const Face& face : faces)
        if (directions.size() < max_faces && face.hits > options.min_face_share * around.hits)
            directions.push_back(face.direction.cast<double>());
    return directions;
}

void add_direction(std::vector<Eigen::Vector3d>& directions, const Eigen::Vector3d& direction, double same_direction) {
    if (direction.norm() < 0.1) return;
    const Eigen::Vector3d unit = direction.normalized();
    const auto same = [&](const Eigen::Vector3d& other) { return std::abs(other.dot(unit)) > same_direction; };
    if (std::none_of(directions.begin(), directions.end(), same)) directions.push_back(unit);
}

// An axis of a polyhedron passes through the middle of a face, an edge (the mean of two faces' directions) or a corner;
// that of a prism is across two of its sides.
void add_polyhedral(std::vector<Eigen::Vector3d>& directions, const ViewsAround& around,
                    const CandidateAxisOptions& options) {
    const std::vector<Eigen::Vector3d> faces = face_directions(around, options);
    const auto add = [&](const Eigen::Vector3d& direction) {
        add_direction(directions, direction, options.same_direction);
    };
    for (const Eigen::Vector3d& face : faces) add(face);
    for (std::size_t i = 0; i < faces.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            add(faces[i] + faces[j]);
            add(faces[i] - faces[j]);
            add(faces[i].cross(faces[j]));
        }
    }
}

double distance_from(const AxisOfRevolution& axis, const Eigen::Vector3d& point) {
    return (point - axis.offset_in_object_m).cross(axis.axis_in_object).norm();
}

}  // namespace

CandidateAxes candidate_axes(const ViewsAround& around, const CandidateAxisOptions& options) {
    const SurfaceMoments surface = moments_of(around);
    const ModelExtent& extent = around.views->extent();
    const double tolerance = options.equal_moments * surface.moments[2];
    const bool low_equal = surface.moments[1] - surface.moments[0] < tolerance;
    const bool high_equal = surface.moments[2] - surface.moments[1] < tolerance;

    std::vector<Eigen::Vector3d> directions;
    for (int i = 0; i < 3; ++i) add_direction(directions, Eigen::Vector3d::Unit(i), options.same_direction);
    for (int i = 0; i < 3; ++i) add_direction(directions, surface.axes.col(i), options.same_direction);
    if (low_equal && high_equal) add_polyhedral(directions, around, options);

    CandidateAxes result;
    for (const Eigen::Vector3d& direction : directions) {
        result.axes.push_back({direction, surface.centroid});
        if (distance_from(result.axes.back(), extent.centre_in_object()) >
            options.distinct_axes_diameters * extent.diameter_m())
            result.axes.push_back({direction, extent.centre_in_object()});
    }
    // Two equal moments do not determine the directions of their axes: they may be any across the third.
    if (low_equal != high_equal)
        result.dihedral_axes.push_back({surface.axes.col(low_equal ? 2 : 0), surface.centroid});
    return result;
}

}  // namespace nearpose
