#include "core/world/place_in_world.hpp"

namespace nearpose {

Matrix6d camera_pose_covariance(const SetupSigmas& setup, const SightingOptions& arm, const Twist& camera_motion) {
    const double turn_rad2 = setup.hand_eye_rad * setup.hand_eye_rad + arm.arm_rotation_rad * arm.arm_rotation_rad;
    const double shift_m2 = setup.hand_eye_m * setup.hand_eye_m + arm.arm_translation_m * arm.arm_translation_m;
    const Twist late = setup.time_offset_frames * camera_motion;
    Twist variances;
    variances << Eigen::Vector3d::Constant(turn_rad2), Eigen::Vector3d::Constant(shift_m2);
    return Matrix6d(variances.asDiagonal()) + late * late.transpose();
}

PlaceInWorld place_in_world(const Pose& camera_from_object, const Matrix6d& covariance, const Pose& world_from_camera,
                            const Matrix6d& camera_pose_covariance) {
    const Matrix6d map = from_camera_twist(camera_from_object, Eigen::Vector3d::Zero());
    return {world_from_camera * camera_from_object, covariance + map * camera_pose_covariance * map.transpose()};
}

}  // namespace nearpose
