#include "apps/scenes/scenario.hpp"

#include <algorithm>
#include <stdexcept>

#include "apps/base/simulation_draws.hpp"
#include "apps/scenes/scenario_paths.hpp"
#include "core/base/check.hpp"

namespace nearpose::simulate {
namespace {

// Five points spread over the box's face at height `z_m`.
std::vector<Eigen::Vector3d> spread_over(const ModelExtent& extent, double z_m) {
    const Eigen::Vector3d centre = extent.centre_in_object();
    const Eigen::Vector3d quarter = 0.25 * (extent.box_max_in_object - extent.box_min_in_object);
    std::vector<Eigen::Vector3d> points;
    for (const auto& [x, y] : {std::pair{0, 0}, {-1, -1}, {1, -1}, {-1, 1}, {1, 1}}) {
        points.emplace_back(centre.x() + x * quarter.x(), centre.y() + y * quarter.y(), z_m);
    }
    return points;
}

void require(bool has_it, const char* option, Scenario scenario) {
    if (has_it) return;
    throw std::invalid_argument("the scenario " + name_of(scenario) + " has no " + option);
}

// The ground's frame for a part that stands on it, or lies turned over.
Pose object_from_ground(const Part& part, bool turned) {
    const Eigen::Vector3d centre = part.extent.centre_in_object();
    Pose pose;
    if (turned) pose.rotation = turned_from_object().rotation;
    pose.translation = {centre.x(), centre.y(),
                        turned ? part.extent.box_max_in_object.z() : part.extent.box_min_in_object.z()};
    return pose;
}

std::vector<Pose> seen_turned(std::vector<Pose> camera_from_turned) {
    for (Pose& pose : camera_from_turned) pose = pose * turned_from_object();
    return camera_from_turned;
}

// Paths around a part that stands still, on its lowest point.
std::vector<Pose> still_part_path(Scenario scenario, const Part& part, const PinholeCamera& camera, int num_frames,
                                  std::uint64_t seed, const ScenarioOptions& options, double frames_per_second) {
    switch (scenario) {
        case Scenario::kPiston:
        case Scenario::kCrankcase:
            return approach_path(part, num_frames, seed, options);
        case Scenario::kSweep:
            return sweep_path(part, num_frames, seed, options);
        case Scenario::kHandheld:
            return hand_path(part, num_frames, seed, options, frames_per_second);
        case Scenario::kClutter:
            return orbit_path(part, camera, num_frames, seed, {});
        case Scenario::kBin:
            return orbit_path(part, camera, num_frames, seed, {1.0, 1.4, 0.5});
        default:
            return std::vector<Pose>(static_cast<std::size_t>(num_frames),
                                     whole_view(part, {Pose::identity()}, camera, seed));
    }
}

}  // namespace

const std::vector<std::string>& scenario_names() {
    // In the order of the enumeration.
    static const std::vector<std::string> names{"baseline", "piston",   "crankcase", "sweep",
                                                "conveyor", "handheld", "clutter",   "bin"};
    return names;
}

const std::string& name_of(Scenario scenario) {
    return scenario_names().at(static_cast<std::size_t>(scenario));
}

Scenario scenario_of(const std::string& name) {
    std::string known;
    for (std::size_t i = 0; i < scenario_names().size(); ++i) {
        if (name == scenario_names()[i]) return static_cast<Scenario>(i);
        known += (known.empty() ? "" : ", ") + scenario_names()[i];
    }
    throw std::invalid_argument("no such scenario: " + name + "; there are: " + known);
}

int default_frames(Scenario scenario) {
    return scenario == Scenario::kBaseline || scenario == Scenario::kConveyor ? 30 : 60;
}

void validate(const ScenarioOptions& options, Scenario scenario) {
    const bool approaches =
        scenario == Scenario::kPiston || scenario == Scenario::kCrankcase || scenario == Scenario::kSweep;
    require(approaches || (!options.far_m && !options.near_m), "far and near distance", scenario);
    require(scenario == Scenario::kConveyor || (!options.conveyor_step_m && !options.conveyor_turn_rad),
            "conveyor step and turn", scenario);
    require(scenario == Scenario::kClutter || !options.occlusion, "occlusion", scenario);
    require(scenario == Scenario::kHandheld || options.trajectory.empty(), "trajectory", scenario);
    if (options.near_m) check_option("near distance [m]", *options.near_m, 0.01, 100.0);
    if (options.far_m) check_option("far distance [m]", *options.far_m, options.near_m.value_or(0.01), 100.0);
    if (options.conveyor_step_m) check_option("conveyor step [m]", *options.conveyor_step_m, 0.0, 1.0);
    if (options.conveyor_turn_rad) check_option("conveyor turn [rad]", *options.conveyor_turn_rad, 0.0, 0.5);
    if (options.occlusion) check_option("occlusion", *options.occlusion, 0.0, kMaxOcclusion);
    if (!options.trajectory.empty()) {
        check_option("poses of the trajectory", static_cast<double>(options.trajectory.size()), 2.0, 1e9);
    }
}

Part engine_block_part(const ModelExtent& extent) {
    constexpr double kDeck_m = 0.120;
    constexpr double kSaddle_m = -0.045;  // the highest line of the half-round bearings
    Part part{extent, kDeck_m, {}};
    for (const double x_m : {-0.109, -0.027, 0.055, 0.137}) part.targets_in_object_m.emplace_back(x_m, 0.0, kDeck_m);
    for (const double x_m : {-0.150, -0.068, 0.014, 0.096, 0.174}) {
        part.underside_targets_in_object_m.emplace_back(x_m, 0.0, kSaddle_m);
    }
    return part;
}

Part box_part(const ModelExtent& extent) {
    const double top_m = extent.box_max_in_object.z();
    return {extent, top_m, spread_over(extent, top_m)};
}

TaskPath task_path(Scenario scenario, const Part& part, const PinholeCamera& camera, int num_frames, std::uint64_t seed,
                   const ScenarioOptions& options, double frames_per_second) {
    validate(camera);
    validate(options, scenario);
    if (num_frames < 1) throw std::invalid_argument("a path needs at least one frame");
    TaskPath path;
    if (scenario == Scenario::kConveyor) {
        const std::vector<Pose> scene_from_object = conveyor_motion(part, num_frames, seed, options);
        const Pose view = whole_view(part, scene_from_object, camera, seed);
        path.camera_from_scene.assign(scene_from_object.size(), view);
        for (const Pose& pose : scene_from_object) path.camera_from_object.push_back(view * pose);
        path.scene_from_ground = object_from_ground(part, false);
        return path;
    }
    // One of the copies in a bin may lie either way up.
    const bool turned = scenario == Scenario::kCrankcase ||
                        (scenario == Scenario::kBin && RandomStream(seed, 0, 0, kTaskDraw).uniform() < 0.5);
    path.scene_from_ground = object_from_ground(part, turned);
    path.camera_from_object = still_part_path(scenario, turned ? turned_over(part) : part, camera, num_frames, seed,
                                              options, frames_per_second);
    if (turned) path.camera_from_object = seen_turned(path.camera_from_object);
    path.camera_from_scene = path.camera_from_object;
    return path;
}

}  // namespace nearpose::simulate
