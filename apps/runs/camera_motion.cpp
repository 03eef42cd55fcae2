#include "apps/runs/camera_motion.hpp"

namespace nearpose::program {

std::optional<Pose> control_of(const std::vector<FrameInfo>& frames, std::size_t index) {
    if (index == 0) return std::nullopt;
    const std::optional<Pose>& now = frames[index].camera_from_world;
    const std::optional<Pose>& before = frames[index - 1].camera_from_world;
    if (!now || !before) return std::nullopt;
    return *now * before->inverse();
}

std::optional<PlaceInWorld> place_of(const std::vector<FrameInfo>& frames, std::size_t index,
                                     const UpdateResult& result, const ArmCheckOptions& setup) {
    const std::optional<Pose>& camera_from_world = frames[index].camera_from_world;
    if (!camera_from_world || result.status == UpdateStatus::kNoPose) return std::nullopt;
    const std::optional<Pose> now_from_before = control_of(frames, index);
    const Twist motion = now_from_before ? log(now_from_before->inverse()) : Twist(Twist::Zero());
    return place_in_world(result.camera_from_object, result.covariance, camera_from_world->inverse(),
                          camera_pose_covariance(setup.still_world.usual, setup.sightings, motion));
}

}  // namespace nearpose::program
