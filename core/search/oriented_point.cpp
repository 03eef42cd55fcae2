#include "core/search/oriented_point.hpp"

#include <algorithm>
#include <cmath>

namespace nearpose {

std::vector<Eigen::Vector3d> directions_all_around(int count) {
    std::vector<Eigen::Vector3d> directions;  // a Fibonacci sphere
    for (int k = 0; k < count; ++k) {
        const double z = 1.0 - (2.0 * k + 1.0) / count, angle = k * M_PI * (3.0 - std::sqrt(5.0));
        const double radius = std::sqrt(1.0 - z * z);
        directions.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
    }
    return directions;
}

Pose camera_looking_along(const Eigen::Vector3d& direction_in_object, const ModelExtent& extent) {
    const auto rotation = Eigen::Quaterniond::FromTwoVectors(direction_in_object, -Eigen::Vector3d::UnitZ());
    return {rotation, Eigen::Vector3d(0, 0, 2.0 * extent.diameter_m()) - rotation * extent.centre_in_object()};
}

View view_from(const ViewGenerator& views, const Eigen::Vector3d& direction_in_object, int side) {
    const PinholeCamera camera{side, side, 1.5 * side, 1.5 * side, 0.5 * (side - 1), 0.5 * (side - 1)};
    return views.generate(camera_looking_along(direction_in_object, views.extent()), camera);
}

std::vector<OrientedPoint> sample_surface(const ViewGenerator& views) {
    constexpr int kDirections = 32, kSide = 64, kAnchors = 4000;
    std::vector<OrientedPoint> all;
    for (const Eigen::Vector3d& direction : directions_all_around(kDirections)) {
        const View view = view_from(views, direction, kSide);
        for (std::size_t p = 0; p < view.size(); ++p)
            all.push_back({view.points_in_object[p], view.normals_in_object[p]});
    }
    std::vector<OrientedPoint> points;
    const std::size_t every = std::max<std::size_t>(1, all.size() / kAnchors);
    for (std::size_t p = 0; p < all.size(); p += every) points.push_back(all[p]);
    return points;
}

Pose pose_aligning(const OrientedPoint& point_of_model, const OrientedPoint& measured, double turn_rad) {
    const Eigen::Vector3d normal = measured.normal.cast<double>();
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(turn_rad, normal));
    const auto align = Eigen::Quaterniond::FromTwoVectors(point_of_model.normal.cast<double>(), normal);
    const Eigen::Quaterniond rotation = (turn * align).normalized();
    return {rotation, measured.point.cast<double>() - rotation * point_of_model.point.cast<double>()};
}

}  // namespace nearpose
