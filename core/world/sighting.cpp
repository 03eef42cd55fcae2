#include "core/world/sighting.hpp"

#include <utility>

#include "core/base/check.hpp"

namespace nearpose {

void validate(const SightingOptions& options) {
    check_option("sightings.max_count", options.max_count, 2, 10000);
    check_option("sightings.goes_on_chi_square", options.goes_on_chi_square, 0.0, 1e6);
    check_option("sightings.arm_rotation_rad", options.arm_rotation_rad, 1e-9, 1.0);
    check_option("sightings.arm_translation_m", options.arm_translation_m, 1e-9, 1.0);
    check_option("sightings.min_motion", options.min_motion, 0.0, 1.0);
}

Sightings after_motion(Sightings sightings, const std::optional<Pose>& now_from_before) {
    if (!now_from_before) return {};
    sightings.arm_from_camera = sightings.arm_from_camera * now_from_before->inverse();
    sightings.camera_motion = log(now_from_before->inverse());
    return sightings;
}

namespace {

// How far the camera has moved between two sightings: its turn, or its shift as a share of the distance to the part.
double motion_between(const Sighting& before, const Sighting& now, const Eigen::Vector3d& centre_in_object) {
    const Pose before_from_now = before.arm_from_camera.inverse() * now.arm_from_camera;
    const double distance_m = (now.camera_from_object * centre_in_object).norm();
    return log(before_from_now).head<3>().norm() + before_from_now.translation.norm() / distance_m;
}

// The turn of the part and the shift of its centre between two sightings, in the arm's axes.
Twist step_between(const Sighting& before, const Sighting& now, const Eigen::Vector3d& centre_in_object) {
    const Pose from = before.arm_from_object(), to = now.arm_from_object();
    Twist step;
    step << from.rotation * twist_about(from, to, centre_in_object).head<3>(),
        to * centre_in_object - from * centre_in_object;
    return step;
}

// Whether the part makes the same step in the world as before, as on a conveyor.
bool goes_on(const std::vector<Sighting>& kept, const Sighting& now, const Eigen::Vector3d& centre_in_object,
             double chi_square) {
    if (kept.size() < 2) return false;
    const Sighting& last = kept.back();
    const Sighting& before = kept[kept.size() - 2];
    const Twist change = step_between(last, now, centre_in_object) - step_between(before, last, centre_in_object);
    const Matrix6d covariance = now.covariance + 4.0 * last.covariance + before.covariance;
    const Eigen::Matrix3d object_from_arm = now.arm_from_object().rotation_matrix().transpose();
    Twist in_object;
    in_object << object_from_arm * change.head<3>(), object_from_arm * change.tail<3>();
    return in_object.dot(covariance.llt().solve(in_object)) < chi_square;
}

}  // namespace

Sightings with_sighting(Sightings sightings, const JointFit& fit, Continuity continuity,
                        const Eigen::Vector3d& centre_in_object, const SightingOptions& options) {
    std::vector<Sighting>& kept = sightings.kept;
    Twist arm;
    arm << Eigen::Vector3d::Constant(options.arm_rotation_rad * options.arm_rotation_rad),
        Eigen::Vector3d::Constant(options.arm_translation_m * options.arm_translation_m);
    const Matrix6d from_camera = from_camera_twist(fit.camera_from_object, centre_in_object);
    Sighting now{sightings.arm_from_camera,
                 fit.camera_from_object,
                 fit.covariance + from_camera * arm.asDiagonal() * from_camera.transpose(),
                 fit.setup_effect,
                 sightings.camera_motion,
                 continuity == Continuity::kOtherMode || continuity == Continuity::kOtherThanAccepted,
                 false};
    const bool pushed =
        continuity == Continuity::kContradicted && !goes_on(kept, now, centre_in_object, options.goes_on_chi_square);
    now.moved = pushed || now.other_mode;
    const bool changed = now.other_mode && sightings.frames_since_move.has_value();
    if (pushed || changed || continuity == Continuity::kOtherThanAccepted)
        sightings.frames_since_move = 0;
    else if (sightings.frames_since_move)
        ++*sightings.frames_since_move;
    const bool at_rest = kept.size() > 1 && continuity == Continuity::kAsPredicted && !kept.back().moved &&
                         motion_between(kept[kept.size() - 2], now, centre_in_object) < options.min_motion;
    if (at_rest)
        kept.back() = now;
    else
        kept.push_back(now);
    if (static_cast<int>(kept.size()) > options.max_count) kept.erase(kept.begin());
    return sightings;
}

}  // namespace nearpose
