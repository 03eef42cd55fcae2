// Sightings of a part by an approaching camera, without noise.
#pragma once

#include <vector>

#include "core/world/sighting.hpp"

namespace nearpose {

inline const Eigen::Vector3d kCentre(0.05, -0.02, 0.03);

inline Twist twist_of(double rx, double ry, double rz, double x, double y, double z) {
    Twist twist;
    twist << rx, ry, rz, x, y, z;
    return twist;
}

// camera_from_world of a frame: an approach from 0.6 m that turns and curves.
inline Pose approach(int frame) {
    const double t = 0.01 * frame;
    return exp(twist_of(0.3 * t, -0.2 * t * t, 0.1 * t, 0.3 * t, 0.1 * t * t, -0.4 * t));
}

inline const Pose kWorldFromObject{Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized())),
                                   {0.02, 0.03, 0.6}};

inline JointFit fit_at(const Pose& camera_from_object) {
    JointFit fit;
    fit.camera_from_object = camera_from_object;
    fit.covariance.diagonal() << Eigen::Vector3d::Constant(1e-7), Eigen::Vector3d::Constant(1e-8);  // 0.3 mrad, 0.1 mm
    return fit;
}

inline constexpr double kFocal_pixels = 600.0;

// What an error of the principal point or of the depth's scale does to a fit that follows the points: the shift of the
// centre grows with its distance.
inline SetupEffect effect_at(const Pose& camera_from_object) {
    const Eigen::Vector3d centre = camera_from_object * kCentre;
    const Eigen::Matrix3d object_from_camera = camera_from_object.rotation_matrix().transpose();
    SetupEffect effect = SetupEffect::Zero();
    effect.col(kFocalLengthError).tail<3>() = object_from_camera * Eigen::Vector3d(-centre.x(), -centre.y(), 0.0);
    effect.col(kImageColumns).tail<3>() = object_from_camera * Eigen::Vector3d(-centre.z() / kFocal_pixels, 0.0, 0.0);
    effect.col(kImageRows).tail<3>() = object_from_camera * Eigen::Vector3d(0.0, -centre.z() / kFocal_pixels, 0.0);
    effect.col(kDepthScaleError).tail<3>() = object_from_camera * centre;
    return effect;
}

// What `seen` gives of each frame as the part's pose in the camera, while `given` says what the arm reports of the
// motion from the frame before.
template <class Seen, class Given>
Sightings sightings_of(int frames, const Seen& seen, const Given& given) {
    Sightings sightings;
    for (int frame = 0; frame < frames; ++frame) {
        if (frame > 0)
            sightings = after_motion(sightings, Pose(given(approach(frame) * approach(frame - 1).inverse())));
        sightings = with_sighting(sightings, seen(frame), Continuity::kAsPredicted, kCentre, {});
    }
    return sightings;
}

}  // namespace nearpose
