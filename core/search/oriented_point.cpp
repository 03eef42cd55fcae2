#include "core/search/oriented_point.hpp"

#include <algorithm>
#include <cmath>

namespace nearpose {

// A Fibonacci sphere: equal steps along z, each turned by the golden angle.
std::vector<Eigen::Vector3d> directions_all_around(int count) {
    std::vector<Eigen::Vector3d> directions;
    for (int k = 0; k < count; ++k) {
        const double z = 1.0 - (2.0 * k + 1.0) / count, angle = k * M_PI * (3.0 - std::sqrt(5.0));
        const double radius = std::sqrt(1.0 - z * z);
        directions.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
    }
    return directions;
}

Pose camera_looking_along(const Eigen::Vector3d& direction_in_object, const ModelExtent& extent,
                          double distance_diameters) {
    const auto rotation = Eigen::Quaterniond::FromTwoVectors(direction_in_object, -Eigen::Vector3d::UnitZ());
    return {rotation,
            Eigen::Vector3d(0, 0, distance_diameters * extent.diameter_m()) - rotation * extent.centre_in_object()};
}

std::vector<OrientedPoint> surface_seen_all_around(const ViewGenerator& views, const SurfaceViewOptions& options) {
    const int side = options.side_pixels;
    const double focal_pixels = options.focal_sides * side, centre = 0.5 * (side - 1);
    const PinholeCamera camera{side, side, focal_pixels, focal_pixels, centre, centre};
    std::vector<OrientedPoint> surface;
    for (const Eigen::Vector3d& direction : directions_all_around(options.directions)) {
        const View view =
            views.generate(camera_looking_along(direction, views.extent(), options.distance_diameters), camera);
        for (std::size_t k = 0; k < view.size(); ++k)
            surface.push_back({view.points_in_object[k], view.normals_in_object[k]});
    }
    return surface;
}

std::vector<OrientedPoint> sample_surface(const ViewGenerator& views, const SurfacePointOptions& options) {
    const std::vector<OrientedPoint> all = surface_seen_all_around(views, options.views);
    std::vector<OrientedPoint> points;
    const std::size_t every = std::max<std::size_t>(1, all.size() / static_cast<std::size_t>(options.count));
    for (std::size_t k = 0; k < all.size(); k += every) points.push_back(all[k]);
    return points;
}

Pose pose_aligning(const OrientedPoint& model, const OrientedPoint& measured, double turn_rad) {
    const Eigen::Vector3d normal = measured.normal.cast<double>();
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(turn_rad, normal));
    const auto align = Eigen::Quaterniond::FromTwoVectors(model.normal.cast<double>(), normal);
    const Eigen::Quaterniond rotation = (turn * align).normalized();
    return {rotation, measured.point.cast<double>() - rotation * model.point.cast<double>()};
}

}  // namespace nearpose
