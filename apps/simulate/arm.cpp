#include "apps/simulate/arm.hpp"

#include "apps/simulate/purpose.hpp"
#include "core/check.hpp"

namespace nearpose::simulate {
namespace {

constexpr double kReach_m = 1.0;  // the object's place in the world, along each axis

Pose hand_eye_error(const ArmErrors& errors, std::uint64_t seed) {
    RandomStream random(seed, 0, 0, kHandEyeDraw);
    Twist twist;
    twist.head<3>() = errors.hand_eye_rotation_rad * random.direction();
    twist.tail<3>() = errors.hand_eye_translation_m * random.direction();
    return exp(twist);
}

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
}

std::vector<Pose> measured_motion(const std::vector<Pose>& camera_from_object, const ArmErrors& errors,
                                  std::uint64_t seed) {
    validate(errors);
    RandomStream random(seed, 0, 0, kWorldDraw);
    Pose object_from_world;
    object_from_world.rotation = random.rotation();
    for (int axis = 0; axis < 3; ++axis) object_from_world.translation[axis] = random.uniform(-kReach_m, kReach_m);
    // Both errors act in the camera's own axes: the reported camera is a little beside the true one.
    const Pose hand_eye = hand_eye_error(errors, seed);
    std::vector<Pose> camera_from_world;
    camera_from_world.reserve(camera_from_object.size());
    for (std::size_t frame = 0; frame < camera_from_object.size(); ++frame) {
        camera_from_world.push_back(frame_error(errors, seed, frame) * hand_eye * camera_from_object[frame] *
                                    object_from_world);
    }
    return camera_from_world;
}

}  // namespace nearpose::simulate
