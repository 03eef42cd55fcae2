#include "core/start.hpp"

#include <algorithm>
#include <cmath>

#include "core/random.hpp"

namespace nearpose {

ParticleSet start_on_sphere(const Observation& observation, const ModelExtent& extent, int count, std::uint64_t seed,
                            std::uint64_t step) {
    const Eigen::Vector3d centre_in_camera =
        observation.mean_distance_m() * observation.centroid_in_camera().normalized();
    ParticleSet particles;
    for (int i = 0; i < count; ++i) {
        RandomStream random(seed, step, static_cast<std::uint64_t>(i), RandomPurpose::kStart);
        const Eigen::Quaterniond rotation = random.rotation();
        particles.poses.push_back({rotation, centre_in_camera - rotation * extent.centre_in_object()});
    }
    particles.weights.assign(particles.poses.size(), 0.0);
    return particles;
}

ParticleSet start_around(const Pose& camera_from_object, const Diffusion& spread, const ModelExtent& extent, int count,
                         std::uint64_t seed, std::uint64_t step) {
    ParticleSet particles;
    particles.poses.assign(count, camera_from_object);
    particles.weights.assign(count, 0.0);
    diffuse(particles, spread, extent.centre_in_object(), seed, step);
    if (count > 0) particles.poses[0] = camera_from_object;
    return particles;
}

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

std::vector<SurfaceAnchor> find_anchors(const ViewGenerator& views) {
    constexpr int kDirections = 32, kSide = 64, kAnchors = 4000;
    std::vector<SurfaceAnchor> all;
    for (const Eigen::Vector3d& direction : directions_all_around(kDirections)) {
        const View view = view_from(views, direction, kSide);
        for (std::size_t p = 0; p < view.size(); ++p)
            all.push_back({view.points_in_object[p], view.normals_in_object[p]});
    }
    std::vector<SurfaceAnchor> anchors;
    const std::size_t every = std::max<std::size_t>(1, all.size() / kAnchors);
    for (std::size_t p = 0; p < all.size(); p += every) anchors.push_back(all[p]);
    return anchors;
}

Pose laid_on(const SurfaceAnchor& anchor, const SurfaceAnchor& measured, double turn_rad) {
    const Eigen::Vector3d normal = measured.normal_in_object.cast<double>();
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(turn_rad, normal));
    const auto align = Eigen::Quaterniond::FromTwoVectors(anchor.normal_in_object.cast<double>(), normal);
    const Eigen::Quaterniond rotation = (turn * align).normalized();
    return {rotation, measured.point_in_object.cast<double>() - rotation * anchor.point_in_object.cast<double>()};
}

ParticleSet start_on_surface(const Observation& observation, const std::vector<SurfaceAnchor>& anchors, int count,
                             std::uint64_t seed, std::uint64_t step, std::uint64_t first_stream) {
    std::vector<int> oriented;  // measured points whose normal is known
    for (std::size_t p = 0; p < observation.normals_in_camera().size(); ++p)
        if (!observation.normals_in_camera()[p].isZero()) oriented.push_back(static_cast<int>(p));
    ParticleSet particles;
    if (anchors.empty() || oriented.empty()) return particles;
    for (int i = 0; i < count; ++i) {
        RandomStream random(seed, step, first_stream + static_cast<std::uint64_t>(i), RandomPurpose::kStart);
        const int measured = oriented[random.below(static_cast<int>(oriented.size()))];
        const SurfaceAnchor& anchor = anchors[random.below(static_cast<int>(anchors.size()))];
        particles.poses.push_back(
            laid_on(anchor, {observation.points_in_camera()[measured], observation.normals_in_camera()[measured]},
                    random.uniform(0.0, 2.0 * M_PI)));
    }
    particles.weights.assign(particles.poses.size(), 0.0);
    return particles;
}

Pose shift_to_seen_surface(const Pose& camera_from_object, const Observation& observation, const ViewGenerator& views,
                           const PinholeCamera& view_camera) {
    const View view = views.generate(camera_from_object, view_camera);
    if (view.size() == 0) return camera_from_object;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3f& point : view.points_in_object) sum += point.cast<double>();
    const Eigen::Vector3d seen_in_camera = camera_from_object * (sum / static_cast<double>(view.size()));
    Pose shifted = camera_from_object;
    shifted.translation += observation.centroid_in_camera() - seen_in_camera;
    return shifted;
}

}  // namespace nearpose
