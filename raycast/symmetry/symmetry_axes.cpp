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

// Directions that much of the surface faces, most faced first.
std::vector<Eigen::Vector3d> faced_directions(const ViewsAround& around) {
    constexpr double kOneFace = 0.996;    // cosine: 5 degrees
    constexpr double kLeastShare = 0.02;  // of the surface
    constexpr std::size_t kMostFaces = 200, kKept = 8;
    struct Face {
        Eigen::Vector3f direction;
        int hits;
    };
    std::vector<Face> faces;
    for_each_hit(around, [&](const auto&, const Eigen::Vector3f& normal) {
        for (Face& face : faces) {
            if (face.direction.dot(normal) < kOneFace) continue;
            ++face.hits;
            return;
        }
        if (faces.size() < kMostFaces) faces.push_back({normal, 1});
    });
    std::stable_sort(faces.begin(), faces.end(), [](const Face& a, const Face& b) { return a.hits > b.hits; });
    std::vector<Eigen::Vector3d> directions;
    for (const Face& face : faces)
        if (directions.size() < kKept && face.hits > kLeastShare * around.hits)
            directions.push_back(face.direction.cast<double>());
    return directions;
}

void add_direction(std::vector<Eigen::Vector3d>& directions, const Eigen::Vector3d& direction) {
    constexpr double kSameAxis = 0.999;  // cosine: 2.5 degrees, which refinement makes up for
    if (direction.norm() < 0.1) return;
    const Eigen::Vector3d unit = direction.normalized();
    const auto same = [&](const Eigen::Vector3d& other) { return std::abs(other.dot(unit)) > kSameAxis; };
    if (std::none_of(directions.begin(), directions.end(), same)) directions.push_back(unit);
}

// An axis of a polyhedron passes through the middle of a face, an edge (the mean of two faces' directions) or a corner;
// that of a prism is across two of its sides.
void add_polyhedral(std::vector<Eigen::Vector3d>& directions, const ViewsAround& around) {
    const std::vector<Eigen::Vector3d> faces = faced_directions(around);
    for (const Eigen::Vector3d& face : faces) add_direction(directions, face);
    for (std::size_t i = 0; i < faces.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            add_direction(directions, faces[i] + faces[j]);
            add_direction(directions, faces[i] - faces[j]);
            add_direction(directions, faces[i].cross(faces[j]));
        }
    }
}

double distance_from(const AxisOfRevolution& axis, const Eigen::Vector3d& point) {
    return (point - axis.offset_in_object_m).cross(axis.axis_in_object).norm();
}

}  // namespace

CandidateAxes candidate_axes(const ViewsAround& around) {
    constexpr double kAlike = 0.06;   // relative difference of two moments; sampling makes 0.02 of it
    constexpr double kApart = 0.015;  // diameters between two axes; refinement makes up for less
    const SurfaceMoments surface = moments_of(around);
    const ModelExtent& extent = around.views->extent();
    const double alike = kAlike * surface.moments[2];
    const bool low_alike = surface.moments[1] - surface.moments[0] < alike;
    const bool high_alike = surface.moments[2] - surface.moments[1] < alike;

    std::vector<Eigen::Vector3d> directions;
    for (int i = 0; i < 3; ++i) add_direction(directions, Eigen::Vector3d::Unit(i));
    for (int i = 0; i < 3; ++i) add_direction(directions, surface.axes.col(i));
    if (low_alike && high_alike) add_polyhedral(directions, around);

    CandidateAxes result;
    for (const Eigen::Vector3d& direction : directions) {
        result.axes.push_back({direction, surface.centroid});
        if (distance_from(result.axes.back(), extent.centre_in_object()) > kApart * extent.diameter_m())
            result.axes.push_back({direction, extent.centre_in_object()});
    }
    // Two equal moments leave the two axes across the third open.
    if (low_alike != high_alike) result.spindles.push_back({surface.axes.col(low_alike ? 2 : 0), surface.centroid});
    return result;
}

}  // namespace nearpose
