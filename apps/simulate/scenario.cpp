#include "apps/simulate/scenario.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "apps/simulate/purpose.hpp"

namespace nearpose::simulate {
namespace {

constexpr double kMinElevationSine = 0.26;  // 15 degrees over the table; flatter views see little but one side
constexpr double kImageMargin = 0.02;       // of the image's sides that the whole part keeps clear in the baseline

// The camera at `eye` that looks at `target` (object frame). Its x axis is `x_hint` without the part along the line of
// sight, turned by `roll_rad` about that line; x_hint may not be parallel to it.
Pose look_at(const Eigen::Vector3d& eye, const Eigen::Vector3d& target, const Eigen::Vector3d& x_hint,
             double roll_rad) {
    Eigen::Matrix3d object_from_camera;
    const Eigen::Vector3d z = (target - eye).normalized();
    const Eigen::Vector3d x = (x_hint - x_hint.dot(z) * z).normalized();
    object_from_camera << x, z.cross(x), z;
    object_from_camera *= Eigen::AngleAxisd(roll_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    return Pose::from_matrix(object_from_camera, eye).inverse();
}

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

Pose baseline_view(const Part& part, const PinholeCamera& camera, std::uint64_t seed) {
    constexpr int kTriesPerDistance = 32;  // directions and rolls, before the camera steps back by 2 %
    constexpr int kMaxSteps = 150;         // up to 20 times the distance
    const Eigen::Vector3d centre = part.extent.centre_in_object();
    double distance_m = kBaselineDistance * part.extent.diameter_m();
    RandomStream random(seed, 0, 0, kPathDraw);
    for (int step = 0; step < kMaxSteps; ++step, distance_m *= 1.02) {
        for (int attempt = 0; attempt < kTriesPerDistance; ++attempt) {
            // Uniform over the cap of the sphere above the least elevation.
            const double height = random.uniform(kMinElevationSine, 1.0);
            const double azimuth = random.uniform(0.0, 2.0 * M_PI);
            const double roll = random.uniform(0.0, 2.0 * M_PI);
            const double radius = std::sqrt(1.0 - height * height);
            const Eigen::Vector3d direction(radius * std::cos(azimuth), radius * std::sin(azimuth), height);
            int hint = 0;
            direction.cwiseAbs().minCoeff(&hint);
            const Pose view = look_at(centre + distance_m * direction, centre, Eigen::Vector3d::Unit(hint), roll);
            if (whole_box_in_view(part.extent, view, camera)) return view;
        }
    }
    throw std::invalid_argument("baseline: this camera cannot have the whole part in view: check fx, fy, cx, cy");
}

double mix(double from, double to, double fraction) {
    return from + (to - from) * fraction;
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

const std::vector<std::string>& scenario_names() {
    static const std::vector<std::string> names{"baseline", "piston"};
    return names;
}

Scenario scenario_of(const std::string& name) {
    if (name == "baseline") return Scenario::kBaseline;
    if (name == "piston") return Scenario::kPiston;
    std::string known;
    for (const std::string& other : scenario_names()) known += (known.empty() ? "" : ", ") + other;
    throw std::invalid_argument("no such scenario: " + name + "; there are: " + known);
}

int default_frames(Scenario scenario) {
    return scenario == Scenario::kPiston ? 60 : 30;
}

Part engine_block_part(const ModelExtent& extent) {
    constexpr double kDeck_m = 0.120;
    Part part{extent, kDeck_m, {}};
    for (const double x_m : {-0.109, -0.027, 0.055, 0.137}) part.targets_in_object_m.emplace_back(x_m, 0.0, kDeck_m);
    return part;
}

Part box_part(const ModelExtent& extent) {
    Part part{extent, extent.box_max_in_object.z(), {}};
    const Eigen::Vector3d centre = extent.centre_in_object();
    const Eigen::Vector3d quarter = 0.25 * (extent.box_max_in_object - extent.box_min_in_object);
    for (const auto& [x, y] : {std::pair{0, 0}, {-1, -1}, {1, -1}, {-1, 1}, {1, 1}}) {
        part.targets_in_object_m.emplace_back(centre.x() + x * quarter.x(), centre.y() + y * quarter.y(),
                                              part.deck_z_m);
    }
    return part;
}

std::vector<Pose> camera_path(Scenario scenario, const Part& part, const PinholeCamera& camera, int num_frames,
                              std::uint64_t seed, const ApproachLimits& limits) {
    validate(camera);
    if (num_frames < 1) throw std::invalid_argument("a path needs at least one frame");
    if (scenario == Scenario::kBaseline) {
        return std::vector<Pose>(static_cast<std::size_t>(num_frames), baseline_view(part, camera, seed));
    }
    const Approach approach(part, seed, limits);
    std::vector<Pose> path;
    for (int frame = 0; frame < num_frames; ++frame) {
        path.push_back(approach.at(num_frames == 1 ? 0.0 : static_cast<double>(frame) / (num_frames - 1)));
    }
    return path;
}

}  // namespace nearpose::simulate
