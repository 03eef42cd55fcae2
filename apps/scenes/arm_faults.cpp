#include "apps/scenes/arm_faults.hpp"

#include <algorithm>
#include <numbers>

#include "apps/base/simulation_draws.hpp"
#include "apps/scenes/arm.hpp"

namespace nearpose::simulate {
namespace {

// Whether the frame lies in the first half of a period of ten, counted from the fault's first.
bool in_burst(const Fault& fault, int frame) {
    constexpr int kPeriod = 10, kBurst = 5;
    return (frame - fault.first) % kPeriod < kBurst;
}

Eigen::Vector3d noise(double sigma_m, RandomStream random) {
    return sigma_m * Eigen::Vector3d(random.gaussian(), random.gaussian(), random.gaussian());
}

Pose shifted(Pose camera_from_world, const Eigen::Vector3d& in_camera_m) {
    camera_from_world.translation += in_camera_m;
    return camera_from_world;
}

// A frame's pose under one fault. `number` is its place among the faults.
Pose with_fault(const Fault& fault, const std::vector<Pose>& reported, int frame, std::uint64_t seed, int number) {
    const Pose& pose = reported[static_cast<std::size_t>(frame)];
    const double metres = 1e-3 * fault.value;
    const auto draws = [&](int of_frame) {
        return RandomStream(seed, static_cast<std::uint64_t>(of_frame), static_cast<std::uint64_t>(number), kFaultDraw);
    };
    switch (fault.kind) {
        case FaultKind::kArmInverted:
            return pose.inverse();
        case FaultKind::kArmTransposed:
            return {pose.rotation.conjugate(), pose.translation};
        case FaultKind::kArmLate:
            return pose_on_path(reported, frame - fault.value);
        case FaultKind::kArmUnits:
            return {pose.rotation, 1e-3 * pose.translation};
        case FaultKind::kArmNoise:
            return in_burst(fault, frame) ? shifted(pose, noise(metres, draws(frame))) : pose;
        case FaultKind::kArmOutlier:
            return frame == fault.first ? shifted(pose, metres * draws(frame).direction()) : pose;
        case FaultKind::kArmFrozen:
            return reported[static_cast<std::size_t>(std::max(0, fault.first - 1))];
        case FaultKind::kHandEye:
            return hand_eye_error({0.0, 0.0, metres, 0.0, 0.0}, seed) * pose;
        default:
            return pose;
    }
}

}  // namespace

std::vector<Pose> with_arm_faults(std::vector<Pose> camera_from_world, const std::vector<Fault>& faults,
                                  std::uint64_t seed) {
    for (std::size_t number = 0; number < faults.size(); ++number) {
        const std::vector<Pose> reported = camera_from_world;
        for (int frame = 0; frame < static_cast<int>(reported.size()); ++frame) {
            if (!faults[number].is_in(frame)) continue;
            camera_from_world[static_cast<std::size_t>(frame)] =
                with_fault(faults[number], reported, frame, seed, static_cast<int>(number));
        }
    }
    return camera_from_world;
}

PinholeCamera written_camera(PinholeCamera camera, const std::vector<Fault>& faults, int frame) {
    for (const Fault& fault : faults) {
        if (!fault.is_in(frame)) continue;
        if (fault.kind == FaultKind::kPrincipalPoint) camera.cx += fault.value;
        double focal = 1.0;
        if (fault.kind == FaultKind::kFocal) focal += 0.01 * fault.value;
        if (fault.kind == FaultKind::kHalfIntrinsics) {
            focal = 0.5;
            camera.cx = 0.5 * (camera.cx + 0.5) - 0.5;  // pixel centres are at whole numbers
            camera.cy = 0.5 * (camera.cy + 0.5) - 0.5;
        }
        camera.fx *= focal;
        camera.fy *= focal;
    }
    return camera;
}

std::optional<Pose> part_motion(const std::vector<Fault>& faults, const Pose& scene_from_ground, std::uint64_t seed,
                                int frame) {
    constexpr double kCarriedStep_m = 0.002, kCarriedTurn_rad = 0.5 * std::numbers::pi / 180.0;
    std::optional<Pose> moved;
    for (std::size_t number = 0; number < faults.size(); ++number) {
        const Fault& fault = faults[number];
        const bool carried = fault.kind == FaultKind::kCarried;
        if ((!carried && fault.kind != FaultKind::kPushed) || frame < fault.first) continue;
        const int steps = std::min(frame, fault.last) - fault.first + 1;
        const double heading = RandomStream(seed, 0, number, kFaultDraw).uniform(0.0, 2.0 * std::numbers::pi);
        const double way_m = carried ? kCarriedStep_m * steps : 1e-3 * fault.value;
        Pose in_ground;
        in_ground.translation = way_m * Eigen::Vector3d(std::cos(heading), std::sin(heading), 0.0);
        if (carried) in_ground.rotation = Eigen::AngleAxisd(kCarriedTurn_rad * steps, Eigen::Vector3d::UnitZ());
        moved = scene_from_ground * in_ground * scene_from_ground.inverse() * moved.value_or(Pose::identity());
    }
    return moved;
}

}  // namespace nearpose::simulate
