#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "apps/base/number_text.hpp"
#include "apps/base/simulation_draws.hpp"
#include "apps/scenes/scenario_paths.hpp"

namespace nearpose::simulate {
namespace {

using data_set::StampedPose;

constexpr double kMaxDeparture = 0.2;  // of the camera from its mean place, in mean distances from the part

// Where the camera is on average: over the table, looking at the part's centre.
struct MeanView {
    MeanView(const Part& part, RandomStream& random) : centre(part.extent.centre_in_object()) {
        const double height = random.uniform(0.45, 0.9), azimuth = random.uniform(0.0, 2.0 * M_PI);
        const double radius = std::sqrt(1.0 - height * height);
        const Eigen::Vector3d direction(radius * std::cos(azimuth), radius * std::sin(azimuth), height);
        roll_rad = random.uniform(0.0, 2.0 * M_PI);
        distance_m = kBaselineDistance * part.extent.diameter_m();
        eye = centre + distance_m * direction;
        x_hint = axis_across(direction);
    }
    Pose camera_from_object() const { return look_at(eye, centre, x_hint, roll_rad); }

    Eigen::Vector3d centre, eye, x_hint;  // object frame [m]
    double distance_m, roll_rad;
};

Pose pose_at(const std::vector<StampedPose>& trajectory, double stamp_s) {
    const auto after = std::upper_bound(trajectory.begin(), trajectory.end(), stamp_s,
                                        [](double stamp, const StampedPose& row) { return stamp < row.stamp_s; });
    if (after == trajectory.begin()) return trajectory.front().pose;
    if (after == trajectory.end()) return trajectory.back().pose;
    const StampedPose &from = *(after - 1), &to = *after;
    return interpolate(from.pose, to.pose, (stamp_s - from.stamp_s) / (to.stamp_s - from.stamp_s));
}

// The mean place and, of rotations that are not far apart, the mean orientation.
Pose mean_of(const std::vector<Pose>& poses) {
    Pose mean;
    Eigen::Vector4d sum = Eigen::Vector4d::Zero();
    for (const Pose& pose : poses) {
        const Eigen::Vector4d q = pose.rotation.coeffs();
        sum += q.dot(poses.front().rotation.coeffs()) < 0.0 ? Eigen::Vector4d(-q) : q;
        mean.translation += pose.translation / static_cast<double>(poses.size());
    }
    mean.rotation = Eigen::Quaterniond(Eigen::Vector4d(sum.normalized()));
    return mean;
}

// mean_from_camera of the frames: a drawn part of the trajectory.
std::vector<Pose> drawn_part(const std::vector<StampedPose>& trajectory, int num_frames, double frames_per_second,
                             RandomStream& random) {
    const double has_s = trajectory.back().stamp_s - trajectory.front().stamp_s;
    const double needs_s = (num_frames - 1) / frames_per_second;
    if (needs_s > has_s + 1e-6) {
        const auto text = [](double time_s) { return data_set::format_number(std::round(time_s * 1e3) / 1e3); };
        throw std::invalid_argument("the trajectory lasts " + text(has_s) + " s, but " + std::to_string(num_frames) +
                                    " frames take " + text(needs_s) +
                                    " s: ask for fewer frames or more frames per second");
    }
    const double start_s = trajectory.front().stamp_s + random.uniform() * std::max(0.0, has_s - needs_s);
    std::vector<Pose> poses;
    for (int frame = 0; frame < num_frames; ++frame) {
        poses.push_back(pose_at(trajectory, start_s + frame / frames_per_second));
    }
    const Pose mean_from_world = mean_of(poses).inverse();
    for (Pose& pose : poses) pose = mean_from_world * pose;
    return poses;
}

// A sum of three sinusoids with drawn phases, one row for each of the six axes; its mean square is 1 over all axes of a
// kind.
struct Sway {
    Sway(double low_hz, double high_hz, RandomStream& random) {
        for (auto& axis : waves) {
            for (Wave& wave : axis) {
                wave.rad_per_s = 2.0 * M_PI * random.uniform(low_hz, high_hz);
                wave.phase_rad = random.uniform(0.0, 2.0 * M_PI);
            }
        }
    }
    Twist at(double time_s) const {
        Twist twist = Twist::Zero();
        for (int axis = 0; axis < 6; ++axis) {
            for (const Wave& wave : waves[static_cast<std::size_t>(axis)]) {
                twist[axis] += std::sin(wave.rad_per_s * time_s + wave.phase_rad) * std::sqrt(2.0 / 9.0);
            }
        }
        return twist;
    }
    struct Wave {
        double rad_per_s = 0.0, phase_rad = 0.0;
    };
    std::array<std::array<Wave, 3>, 6> waves;
};

std::vector<Pose> made_up_hand(const MeanView& mean, int num_frames, double frames_per_second, RandomStream& random) {
    // Root mean squares: a slow sway that the hand aims against, and tremor that it does not.
    constexpr double kSway = 0.12, kAim_rad = 0.03;  // of the distance
    constexpr double kTremor_m = 0.001, kTremor_rad = 0.0052;
    const Sway slow(0.1, 0.5, random), tremor(3.0, 9.0, random);
    std::vector<Pose> path;
    for (int frame = 0; frame < num_frames; ++frame) {
        const double time_s = frame / frames_per_second;
        const Twist away = slow.at(time_s), shake = tremor.at(time_s);
        const Eigen::Vector3d eye = mean.eye + kSway * mean.distance_m * away.tail<3>();
        Twist local;
        local << kAim_rad * away.head<3>() + kTremor_rad * shake.head<3>(), kTremor_m * shake.tail<3>();
        path.push_back(exp(local) * look_at(eye, mean.centre, mean.x_hint, mean.roll_rad));
    }
    return path;
}

}  // namespace

std::vector<Pose> hand_path(const Part& part, int num_frames, std::uint64_t seed, const ScenarioOptions& options,
                            double frames_per_second) {
    RandomStream random(seed, 0, 0, kPathDraw);
    const MeanView mean(part, random);
    if (options.trajectory.empty()) return made_up_hand(mean, num_frames, frames_per_second, random);
    std::vector<Pose> mean_from_camera = drawn_part(options.trajectory, num_frames, frames_per_second, random);
    double departure_m = 0.0;
    for (const Pose& pose : mean_from_camera) departure_m = std::max(departure_m, pose.translation.norm());
    // As large as the part is beside the engine block, but never so large that the part is lost.
    double scale = part.extent.diameter_m() / kReferenceDiameter_m;
    if (scale * departure_m > kMaxDeparture * mean.distance_m) scale = kMaxDeparture * mean.distance_m / departure_m;
    std::vector<Pose> path;
    for (Pose& pose : mean_from_camera) {
        pose.translation *= scale;
        path.push_back(pose.inverse() * mean.camera_from_object());
    }
    return path;
}

}  // namespace nearpose::simulate
