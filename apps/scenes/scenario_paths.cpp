#include "apps/scenes/scenario_paths.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "apps/base/simulation_draws.hpp"

namespace nearpose::simulate {
namespace {

constexpr double kMinElevationSine = 0.26;  // 15 degrees over the table; flatter views see little but one side
constexpr double kImageMargin = 0.02;       // of the image's sides that the whole part keeps clear
constexpr double kStepBack = 1.02;          // times the distance, where the part is not in view
constexpr int kMaxStepsBack = 150;          // up to 20 times the distance

bool whole_box_in_view(const ModelExtent& extent, const Pose& camera_from_object, const PinholeCamera& camera) {
    const double margin_u = kImageMargin * camera.width, margin_v = kImageMargin * camera.height;
    for (int corner = 0; corner < 8; ++corner) {
        Eigen::Vector3d point;
        for (int axis = 0; axis < 3; ++axis) {
            point[axis] = (corner >> axis & 1) != 0 ? extent.box_max_in_object[axis] : extent.box_min_in_object[axis];
        }
        point = camera_from_object * point;
        if (!(point.z() > 1e-6)) return false;
        const Eigen::Vector2d pixel = camera.project(point);
        if (!(pixel.x() > margin_u && pixel.x() < camera.width - 1 - margin_u)) return false;
        if (!(pixel.y() > margin_v && pixel.y() < camera.height - 1 - margin_v)) return false;
    }
    return true;
}

[[noreturn]] void throw_out_of_view() {
    throw std::invalid_argument(
        "this camera cannot have the whole part in view in all frames: check fx, fy, cx, cy, and how far the part "
        "moves");
}

double mix(double from, double to, double fraction) {
    return from + (to - from) * fraction;
}

// Lengths of the paths are given for a part of the engine block's size.
double scale_of(const Part& part) {
    const double scale = part.extent.diameter_m() / kReferenceDiameter_m;
    return std::abs(scale - 1.0) < 1e-3 ? 1.0 : scale;
}

// One approach; all draws are made when it is constructed.
struct Approach {
    Approach(const Part& part, std::uint64_t seed, const ApproachLimits& limits);
    // `progress` runs from 0 (far) to 1 (near).
    Pose at(double progress) const;

    Eigen::Vector3d bore, far_offset, near_offset;  // object frame [m]
    double far_m, near_m;
    double far_tilt_rad, near_tilt_rad, azimuth_rad, swing_rad, roll_rad, roll_change_rad;
};

Approach::Approach(const Part& part, std::uint64_t seed, const ApproachLimits& limits) {
    RandomStream random(seed, 0, 0, kPathDraw);
    const double scale = part.extent.diameter_m() / kReferenceDiameter_m;
    const auto offset = [&](double max_m) {
        const double x = random.uniform(-max_m, max_m), y = random.uniform(-max_m, max_m);
        return Eigen::Vector3d(scale * Eigen::Vector3d(x, y, 0.0));
    };
    bore = part.targets_in_object_m.at(
        static_cast<std::size_t>(random.below(static_cast<int>(part.targets_in_object_m.size()))));
    far_offset = offset(limits.max_far_offset_m);
    near_offset = offset(limits.max_near_offset_m);
    far_m = scale * limits.far_m;
    near_m = scale * limits.near_m;
    far_tilt_rad = random.uniform(limits.min_far_tilt_rad, limits.max_far_tilt_rad);
    near_tilt_rad = random.uniform(0.0, limits.max_near_tilt_rad);
    azimuth_rad = random.uniform(0.0, 2.0 * M_PI);
    swing_rad = random.uniform(-limits.max_swing_rad, limits.max_swing_rad);
    roll_rad = random.uniform(0.0, 2.0 * M_PI);
    roll_change_rad = random.uniform(-limits.max_roll_change_rad, limits.max_roll_change_rad);
}

Pose Approach::at(double progress) const {
    const double s = progress * progress * (3.0 - 2.0 * progress);  // ease in and out: no speed at both ends
    const double height_m = mix(far_m, near_m, s);
    const double tilt = mix(far_tilt_rad, near_tilt_rad, s);
    const double azimuth = azimuth_rad + s * swing_rad;
    const Eigen::Vector3d target = bore + (1.0 - s) * far_offset + s * near_offset;
    const Eigen::Vector3d lateral(std::cos(azimuth), std::sin(azimuth), 0.0);
    const Eigen::Vector3d eye = target + height_m * (Eigen::Vector3d::UnitZ() + std::tan(tilt) * lateral);
    // The line of sight stays far from the object's x axis, so that axis may define the roll all the way.
    return look_at(eye, target, Eigen::Vector3d::UnitX(), roll_rad + s * roll_change_rad);
}

}  // namespace

Pose look_at(const Eigen::Vector3d& eye, const Eigen::Vector3d& target, const Eigen::Vector3d& x_hint,
             double roll_rad) {
    Eigen::Matrix3d object_from_camera;
    const Eigen::Vector3d z = (target - eye).normalized();
    const Eigen::Vector3d x = (x_hint - x_hint.dot(z) * z).normalized();
    object_from_camera << x, z.cross(x), z;
    object_from_camera *= Eigen::AngleAxisd(roll_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    return Pose::from_matrix(object_from_camera, eye).inverse();
}

Eigen::Vector3d axis_across(const Eigen::Vector3d& direction) {
    int axis = 0;
    direction.cwiseAbs().minCoeff(&axis);
    return Eigen::Vector3d::Unit(axis);
}

double progress_of(int frame, int num_frames) {
    return num_frames == 1 ? 0.0 : static_cast<double>(frame) / (num_frames - 1);
}

Pose whole_view(const Part& part, const std::vector<Pose>& scene_from_object, const PinholeCamera& camera,
                std::uint64_t seed) {
    constexpr int kTriesPerDistance = 32;  // directions and rolls, before the camera steps back
    const Eigen::Vector3d centre = part.extent.centre_in_object();
    double distance_m = kBaselineDistance * part.extent.diameter_m();
    RandomStream random(seed, 0, 0, kPathDraw);
    for (int step = 0; step < kMaxStepsBack; ++step, distance_m *= kStepBack) {
        for (int attempt = 0; attempt < kTriesPerDistance; ++attempt) {
            // Uniform over the cap of the sphere above the least elevation.
            const double height = random.uniform(kMinElevationSine, 1.0);
            const double azimuth = random.uniform(0.0, 2.0 * M_PI);
            const double roll = random.uniform(0.0, 2.0 * M_PI);
            const double radius = std::sqrt(1.0 - height * height);
            const Eigen::Vector3d direction(radius * std::cos(azimuth), radius * std::sin(azimuth), height);
            const Pose view = look_at(centre + distance_m * direction, centre, axis_across(direction), roll);
            if (std::all_of(scene_from_object.begin(), scene_from_object.end(),
                            [&](const Pose& pose) { return whole_box_in_view(part.extent, view * pose, camera); })) {
                return view;
            }
        }
    }
    throw_out_of_view();
}

Pose turned_from_object() {
    Pose pose;
    pose.rotation = Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0);
    return pose;
}

Part turned_over(const Part& part) {
    Part turned;
    const Eigen::Vector3d a = part.extent.box_min_in_object, b = part.extent.box_max_in_object;
    turned.extent = {Eigen::Vector3d(a.x(), -b.y(), -b.z()), Eigen::Vector3d(b.x(), -a.y(), -a.z())};
    if (part.underside_targets_in_object_m.empty()) return box_part(turned.extent);
    for (const Eigen::Vector3d& target : part.underside_targets_in_object_m) {
        turned.targets_in_object_m.push_back(turned_from_object() * target);
    }
    turned.deck_z_m = turned.targets_in_object_m.front().z();
    return turned;
}

std::vector<Pose> approach_path(const Part& part, int num_frames, std::uint64_t seed, const ScenarioOptions& options) {
    Approach approach(part, seed, {});
    if (options.far_m) approach.far_m = *options.far_m;
    if (options.near_m) approach.near_m = *options.near_m;
    std::vector<Pose> path;
    for (int frame = 0; frame < num_frames; ++frame) path.push_back(approach.at(progress_of(frame, num_frames)));
    return path;
}

std::vector<Pose> sweep_path(const Part& part, int num_frames, std::uint64_t seed, const ScenarioOptions& options) {
    RandomStream random(seed, 0, 0, kPathDraw);
    const std::vector<Eigen::Vector3d>& points =
        part.surface_points_in_object_m.empty() ? part.targets_in_object_m : part.surface_points_in_object_m;
    const Eigen::Vector3d target = points.at(static_cast<std::size_t>(random.below(static_cast<int>(points.size()))));
    const double tilt = random.uniform(0.0, kMaxSweepTilt_rad), azimuth = random.uniform(0.0, 2.0 * M_PI);
    const double roll = random.uniform(0.0, 2.0 * M_PI);
    const Eigen::Vector3d direction(std::sin(tilt) * std::cos(azimuth), std::sin(tilt) * std::sin(azimuth),
                                    std::cos(tilt));
    const double far_m = options.far_m.value_or(scale_of(part) * kSweepFar_m);
    const double near_m = options.near_m.value_or(scale_of(part) * kSweepNear_m);
    std::vector<Pose> path;
    for (int frame = 0; frame < num_frames; ++frame) {
        const double distance_m = mix(far_m, near_m, progress_of(frame, num_frames));
        path.push_back(look_at(target + distance_m * direction, target, Eigen::Vector3d::UnitX(), roll));
    }
    return path;
}

std::vector<Pose> conveyor_motion(const Part& part, int num_frames, std::uint64_t seed,
                                  const ScenarioOptions& options) {
    RandomStream random(seed, 0, 0, kTaskDraw);
    const double heading = random.uniform(0.0, 2.0 * M_PI);
    const double drawn_step_m = random.uniform(0.0, kMaxConveyorStep_m);
    const double drawn_turn_rad = random.uniform(0.0, kMaxConveyorTurn_rad);
    const double sense = random.uniform() < 0.5 ? -1.0 : 1.0;
    const double step_m = options.conveyor_step_m.value_or(drawn_step_m);
    const double turn_rad = sense * options.conveyor_turn_rad.value_or(drawn_turn_rad);
    const Eigen::Vector3d direction(std::cos(heading), std::sin(heading), 0.0);
    const Eigen::Vector3d centre = part.extent.centre_in_object();
    std::vector<Pose> scene_from_object;
    for (int frame = 0; frame < num_frames; ++frame) {
        const double steps = frame - 0.5 * (num_frames - 1);  // half-way the part is where it would stand still
        Pose pose;
        pose.rotation = Eigen::AngleAxisd(steps * turn_rad, Eigen::Vector3d::UnitZ());
        pose.translation = centre + steps * step_m * direction - pose.rotation * centre;
        scene_from_object.push_back(pose);
    }
    return scene_from_object;
}

std::vector<Pose> orbit_path(const Part& part, const PinholeCamera& camera, int num_frames, std::uint64_t seed,
                             const OrbitLimits& limits) {
    RandomStream random(seed, 0, 0, kPathDraw);
    const double elevation = random.uniform(limits.min_elevation_rad, limits.max_elevation_rad);
    const double azimuth = random.uniform(0.0, 2.0 * M_PI);
    const double swing = random.uniform(-limits.max_swing_rad, limits.max_swing_rad);
    const double nearing = random.uniform(0.0, 0.1);  // of the distance, over the path
    const double roll = random.uniform(0.0, 2.0 * M_PI), roll_change = random.uniform(-0.2, 0.2);
    const Eigen::Vector3d centre = part.extent.centre_in_object();
    double distance_m = kBaselineDistance * part.extent.diameter_m();
    for (int step = 0; step < kMaxStepsBack; ++step, distance_m *= kStepBack) {
        std::vector<Pose> path;
        for (int frame = 0; frame < num_frames; ++frame) {
            const double progress = progress_of(frame, num_frames);
            const double around = azimuth + swing * (progress - 0.5);
            const Eigen::Vector3d direction(std::cos(elevation) * std::cos(around),
                                            std::cos(elevation) * std::sin(around), std::sin(elevation));
            const Eigen::Vector3d eye = centre + (1.0 + nearing * (0.5 - progress)) * distance_m * direction;
            // The camera's x axis stays near the table's plane but for the roll.
            const Eigen::Vector3d level(-std::sin(around), std::cos(around), 0.0);
            path.push_back(look_at(eye, centre, level, roll + progress * roll_change));
            if (!whole_box_in_view(part.extent, path.back(), camera)) break;
        }
        if (static_cast<int>(path.size()) == num_frames && whole_box_in_view(part.extent, path.back(), camera))
            return path;
    }
    throw_out_of_view();
}

}  // namespace nearpose::simulate
