#include "apps/scenes/clutter_world.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/base/simulation_draws.hpp"
#include "apps/scenes/parts.hpp"
#include "apps/scenes/scene.hpp"

namespace nearpose::simulate {
namespace {

constexpr int kTrialWidth = 128;          // of the images that the occlusion is tried in [pixels]
constexpr int kMaxTrialFrames = 60;       //
constexpr double kOcclusionSlack = 0.01;  // the least of what the trial's coarse pixels may be wrong by

// What is seen of the part in one frame without the gripper.
struct Trial {
    int silhouette = 0;               // [trial pixels]
    std::vector<int> visible_pixels;  // indices into the trial's image
};

PinholeCamera trial_camera(const PinholeCamera& camera) {
    const int stride = std::max(1, camera.width / kTrialWidth);
    return camera_of({0, 0, stride, (camera.width + stride - 1) / stride, (camera.height + stride - 1) / stride},
                     camera);
}

std::vector<Trial> trials_of(const Mesh& mesh, const World& world, const TaskPath& path, const PinholeCamera& camera) {
    const Scene scene(mesh, world);
    std::vector<Trial> trials;
    const std::size_t count = path.camera_from_object.size();
    const std::size_t step = (count + kMaxTrialFrames - 1) / kMaxTrialFrames;
    for (std::size_t frame = 0; frame < count; frame += step) {
        const RenderedFrame rendered =
            scene.render(path.camera_from_object[frame], path.camera_from_scene[frame], camera);
        Trial trial;
        trial.silhouette = rendered.instances.front().truth.silhouette_pixels;
        const std::vector<std::uint8_t>& visible = rendered.instances.front().visible.value;
        for (std::size_t pixel = 0; pixel < visible.size(); ++pixel) {
            if (visible[pixel] != 0) trial.visible_pixels.push_back(static_cast<int>(pixel));
        }
        trials.push_back(std::move(trial));
    }
    return trials;
}

// The largest fraction of the silhouette that is hidden in any frame, with a gripper that covers `covered` pixels.
double worst_occlusion(const std::vector<Trial>& trials, const std::vector<char>& covered) {
    double worst = 0.0;
    for (const Trial& trial : trials) {
        const auto visible = std::count_if(trial.visible_pixels.begin(), trial.visible_pixels.end(),
                                           [&](int pixel) { return covered[static_cast<std::size_t>(pixel)] == 0; });
        worst = std::max(worst, 1.0 - static_cast<double>(visible) / std::max(1, trial.silhouette));
    }
    return worst;
}

// A parallel gripper that reaches into the image from one of its sides. Lengths in half diagonals of the part as it
// appears; `reach` is that of the finger tips from beyond the image.
struct Gripper {
    Gripper(const Part& part, const TaskPath& path, std::uint64_t seed);
    Mesh reaching(double reach) const;

    double depth_m, thickness_m;  // from the camera to its front
    double unit_m;                // half the part's apparent diameter at that depth
    double turn_rad, aside;       // about the line of sight; of its middle from the image's
};

Gripper::Gripper(const Part& part, const TaskPath& path, std::uint64_t seed) {
    RandomStream random(seed, 1, 0, kThingsDraw);
    const Eigen::Vector3d centre = part.extent.centre_in_object();
    double nearest_m = std::numeric_limits<double>::infinity(), mean_m = 0.0;
    for (const Pose& pose : path.camera_from_object) {
        const double depth = (pose * centre).z();
        nearest_m = std::min(nearest_m, depth - 0.5 * part.extent.diameter_m());
        mean_m += depth / static_cast<double>(path.camera_from_object.size());
    }
    depth_m = 0.6 * nearest_m;
    thickness_m = 0.2 * nearest_m;
    unit_m = 0.5 * part.extent.diameter_m() * depth_m / mean_m;
    turn_rad = random.uniform(0.0, 2.0 * M_PI);
    aside = random.uniform(-0.3, 0.3);
}

Mesh Gripper::reaching(double reach) const {
    constexpr double kFar = 6.0;  // where it begins, out of every image
    constexpr double kFingerLength = 0.9, kFingerWidth = 0.25, kOpening = 0.3;
    Pose camera_from_gripper;
    camera_from_gripper.rotation = Eigen::AngleAxisd(turn_rad, Eigen::Vector3d::UnitZ());
    Mesh mesh;
    // Along x: from the side at -kFar to the tips; across: y.
    const auto add = [&](double to_x, double y0, double y1) {
        append(mesh,
               box_mesh(unit_m * Eigen::Vector3d(-kFar, aside + y0, 0.0) + depth_m * Eigen::Vector3d::UnitZ(),
                        unit_m * Eigen::Vector3d(to_x, aside + y1, 0.0) +
                            (depth_m + thickness_m) * Eigen::Vector3d::UnitZ()),
               camera_from_gripper);
    };
    const double tip = reach - kFar;
    add(tip, kOpening, kOpening + kFingerWidth);
    add(tip, -kOpening - kFingerWidth, -kOpening);
    add(tip - kFingerLength, -2.0 * kOpening - kFingerWidth, 2.0 * kOpening + kFingerWidth);
    return mesh;
}

std::vector<char> covered_by(const Mesh& mesh, const PinholeCamera& camera) {
    std::vector<char> covered(static_cast<std::size_t>(camera.width) * camera.height, 0);
    for (const int pixel : EmbreeScene(mesh).cast(Pose::identity(), camera).pixels) {
        covered[static_cast<std::size_t>(pixel)] = 1;
    }
    return covered;
}

// The gripper that hides `occlusion` in the frame with the most: the farther it reaches, the more it hides.
Mesh fitted_gripper(const Gripper& gripper, const std::vector<Trial>& trials, const PinholeCamera& camera,
                    double occlusion) {
    double least = 0.05, most = 12.0;  // reach
    for (int step = 0; step < 14; ++step) {
        const double reach = 0.5 * (least + most);
        const bool too_much = worst_occlusion(trials, covered_by(gripper.reaching(reach), camera)) > occlusion;
        (too_much ? most : least) = reach;
    }
    return gripper.reaching(least);
}

// Boxes on the ground around the part; all draws are the same for any height.
Mesh boxes_in_ground(const Part& part, double camera_angle_rad, double height_factor, std::uint64_t seed) {
    RandomStream random(seed, 0, 0, kThingsDraw);
    const double diameter_m = part.extent.diameter_m();
    const Eigen::Vector3d size = part.extent.box_max_in_object - part.extent.box_min_in_object;
    Mesh boxes;
    // Seven places around the part; the one behind it is the other part's.
    for (int place = 1; place < 7; ++place) {
        const Eigen::Vector3d half =
            diameter_m * Eigen::Vector3d(random.uniform(0.06, 0.14), random.uniform(0.06, 0.14),
                                         0.5 * random.uniform(0.1, 0.4) * height_factor);
        const double angle = camera_angle_rad + M_PI + 2.0 * M_PI * (place + random.uniform(-0.25, 0.25)) / 7.0;
        const double away_m =
            0.5 * size.head<2>().norm() + half.head<2>().norm() + diameter_m * random.uniform(0.0, 0.2);
        Pose pose;
        pose.rotation = Eigen::AngleAxisd(random.uniform(0.0, M_PI), Eigen::Vector3d::UnitZ());
        pose.translation = {away_m * std::cos(angle), away_m * std::sin(angle), half.z()};
        append(boxes, box_mesh(-half, half), pose);
    }
    return boxes;
}

double camera_angle(const TaskPath& path) {
    const Pose& middle = path.camera_from_scene[path.camera_from_scene.size() / 2];
    const Eigen::Vector3d eye_in_ground = path.scene_from_ground.inverse() * middle.inverse().translation;
    return std::atan2(eye_in_ground.y(), eye_in_ground.x());
}

// Another built-in part behind the tracked one, where it hides nothing of it.
OtherPart other_part(const Part& part, const TaskPath& path, std::uint64_t seed, const std::string& tracked_name) {
    RandomStream random(seed, 3, 0, kThingsDraw);
    std::vector<std::string> names = part_names();
    names.erase(std::remove(names.begin(), names.end(), tracked_name), names.end());
    const std::string& name = names[static_cast<std::size_t>(random.below(static_cast<int>(names.size())))];
    EmbeddedPart embedded = embedded_part(name);
    const Eigen::Vector3d size = embedded.part.extent.box_max_in_object - embedded.part.extent.box_min_in_object;
    const Eigen::Vector3d tracked_size = part.extent.box_max_in_object - part.extent.box_min_in_object;
    const double away_m = 0.5 * (size.head<2>().norm() + tracked_size.head<2>().norm()) * random.uniform(1.0, 1.2);
    const double angle = camera_angle(path) + M_PI + random.uniform(-0.2, 0.2);
    Pose ground_from_other;
    ground_from_other.rotation = Eigen::AngleAxisd(random.uniform(0.0, 2.0 * M_PI), Eigen::Vector3d::UnitZ());
    ground_from_other.translation =
        Eigen::Vector3d(away_m * std::cos(angle), away_m * std::sin(angle), 0.5 * size.z()) -
        ground_from_other.rotation * embedded.part.extent.centre_in_object();
    return {std::move(embedded.mesh), tracked_name.empty() ? 0 : object_id_of(name),
            path.scene_from_ground * ground_from_other};
}

}  // namespace

void add_clutter(World& world, const Mesh& mesh, const Part& part, const TaskPath& path, const PinholeCamera& camera,
                 std::uint64_t seed, const WorldOptions& options) {
    RandomStream random(seed, 2, 0, kThingsDraw);
    const double drawn = random.uniform(kMinOcclusion, kMaxOcclusion);
    const double occlusion = std::max(0.0, options.occlusion.value_or(drawn) - kOcclusionSlack);
    const PinholeCamera coarse = trial_camera(camera);
    const std::vector<char> nothing(static_cast<std::size_t>(coarse.width) * coarse.height, 0);
    world.other = other_part(part, path, seed, options.part_name);
    const Mesh without_boxes = world.surroundings_in_scene;
    std::vector<Trial> trials;
    for (double height_factor = 1.0; height_factor > 0.05; height_factor *= 0.6) {
        world.surroundings_in_scene = without_boxes;
        append(world.surroundings_in_scene, boxes_in_ground(part, camera_angle(path), height_factor, seed),
               path.scene_from_ground);
        trials = trials_of(mesh, world, path, coarse);
        if (worst_occlusion(trials, nothing) <= 0.6 * occlusion) break;
    }
    world.gripper_in_camera = fitted_gripper(Gripper(part, path, seed), trials, coarse, occlusion);
}

}  // namespace nearpose::simulate
