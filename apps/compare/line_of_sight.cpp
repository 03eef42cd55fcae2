#include "apps/compare/line_of_sight.hpp"

#include <cmath>
#include <numbers>
#include <optional>

#include "apps/compare/purpose.hpp"

namespace nearpose::compare {
namespace {

constexpr double kMaxTilt_rad = 0.45;
constexpr double kMaxOffsetDiameters = 0.12;  // of the target along the upper face's x and y
constexpr double kMaxDepthDiameters = 0.05;   // of the target under the upper face
constexpr int kTries = 64;

// The first surface under (x, y), seen from above the part.
std::optional<Eigen::Vector3d> surface_under(const EmbreeScene& scene, double x, double y) {
    const ModelExtent& extent = scene.extent();
    const Eigen::Quaterniond down(Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()));
    const Pose object_from_camera{down, {x, y, extent.box_max_in_object.z() + extent.diameter_m()}};
    const RayHits hit = scene.cast(object_from_camera.inverse(), {1, 1, 1.0, 1.0, 0.0, 0.0});
    if (hit.size() == 0) return std::nullopt;
    return hit.points_in_object.front().cast<double>();
}

Eigen::Vector3d draw_target(const EmbreeScene& scene, const simulate::Part& part, RandomStream& random) {
    const int aim = random.below(static_cast<int>(part.targets_in_object_m.size()));
    const Eigen::Vector3d centre = part.targets_in_object_m.at(static_cast<std::size_t>(aim));
    const double diameter_m = part.extent.diameter_m();
    const double reach_m = kMaxOffsetDiameters * diameter_m;
    for (int attempt = 0; attempt < kTries; ++attempt) {
        const double x = centre.x() + random.uniform(-reach_m, reach_m);
        const double y = centre.y() + random.uniform(-reach_m, reach_m);
        const auto target = surface_under(scene, x, y);
        if (target && target->z() > part.deck_z_m - kMaxDepthDiameters * diameter_m) return *target;
    }
    return centre;  // a part with hardly any upper face
}

}  // namespace

LineOfSight draw_line_of_sight(const EmbreeScene& scene, const simulate::Part& part, std::uint64_t seed) {
    RandomStream random(seed, 0, 0, kLineOfSightDraw);
    LineOfSight line;
    line.target_in_object = draw_target(scene, part, random);
    const double tilt = random.uniform(0.0, kMaxTilt_rad);
    const double azimuth = random.uniform(0.0, 2.0 * std::numbers::pi);
    const double roll = random.uniform(0.0, 2.0 * std::numbers::pi);
    const Eigen::Vector3d forward(std::sin(tilt) * std::cos(azimuth), std::sin(tilt) * std::sin(azimuth),
                                  -std::cos(tilt));
    line.object_from_camera = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), forward) *
                              Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ());
    return line;
}

Pose pose_at(const LineOfSight& line, double distance_m) {
    const Eigen::Vector3d forward = line.object_from_camera * Eigen::Vector3d::UnitZ();
    const Pose object_from_camera{line.object_from_camera, line.target_in_object - distance_m * forward};
    return object_from_camera.inverse();
}

}  // namespace nearpose::compare
