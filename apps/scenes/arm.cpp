#include "apps/scenes/arm.hpp"

#include <algorithm>
#include <cmath>

#include "apps/base/simulation_draws.hpp"
#include "core/base/check.hpp"

namespace nearpose::simulate {
namespace {

constexpr double kReach_m = 1.0;  // the object's place in the world, along each axis

Pose frame_error(const ArmErrors& errors, std::uint64_t seed, std::uint64_t frame) {
    RandomStream random(seed, frame, 0, kArmDraw);
    Twist twist;
    for (int i = 0; i < 6; ++i) {
        twist[i] = (i < 3 ? errors.sigma_rotation_rad : errors.sigma_translation_m) * random.gaussian();
    }
    return exp(twist);
}

}  // namespace

void validate(const ArmErrors& errors) {
    check_option("arm.sigma_translation_m", errors.sigma_translation_m, 0.0, 1.0);
    check_option("arm.sigma_rotation_rad", errors.sigma_rotation_rad, 0.0, 1.0);
    check_option("arm.hand_eye_translation_m", errors.hand_eye_translation_m, 0.0, 1.0);
    check_option("arm.hand_eye_rotation_rad", errors.hand_eye_rotation_rad, 0.0, 1.0);
    check_option("arm.time_offset_s", errors.time_offset_s, -10.0, 10.0);
}

std::vector<Pose> measured_motion(const std::vector<Pose>& camera_from_scene, const ArmErrors& errors,
                                  std::uint64_t seed, double frames_per_second) {
    validate(errors);
    RandomStream random(seed, 0, 0, kWorldDraw);
    Pose scene_from_world;
    scene_from_world.rotation = random.rotation();
    for (int axis = 0; axis < 3; ++axis) scene_from_world.translation[axis] = random.uniform(-kReach_m, kReach_m);
    // Both errors act in the camera's own axes: the reported camera is a little beside the true one.
    const Pose hand_eye = hand_eye_error(errors, seed);
    const double offset = errors.time_offset_s * frames_per_second;  // [frames]
    std::vector<Pose> camera_from_world;
    camera_from_world.reserve(camera_from_scene.size());
    for (std::size_t frame = 0; frame < camera_from_scene.size(); ++frame) {
        const Pose true_pose = offset == 0.0 ? camera_from_scene[frame]
                                             : pose_on_path(camera_from_scene, static_cast<double>(frame) + offset);
        camera_from_world.push_back(frame_error(errors, seed, frame) * hand_eye * true_pose * scene_from_world);
    }
    return camera_from_world;
}

Pose hand_eye_error(const ArmErrors& errors, std::uint64_t seed) {
    RandomStream random(seed, 0, 0, kHandEyeDraw);
    Twist twist;
    twist.head<3>() = errors.hand_eye_rotation_rad * random.direction();
    twist.tail<3>() = errors.hand_eye_translation_m * random.direction();
    return exp(twist);
}

Pose pose_on_path(const std::vector<Pose>& path, double place) {
    if (path.size() < 2) return path.front();
    const double before = std::clamp(std::floor(place), 0.0, static_cast<double>(path.size() - 2));
    const auto index = static_cast<std::size_t>(before);
    return interpolate(path[index], path[index + 1], place - before);
}

}  // namespace nearpose::simulate
