#include "core/world/arm_motion.hpp"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <optional>

#include "core/base/check.hpp"

namespace nearpose {
namespace {

// Two successive sightings and the motion that the arm gives between them.
struct Pair {
    const Sighting& before;
    const Sighting& now;
    Pose now_from_before;
};

constexpr double kPi = 3.14159265358979323846;

Pose turned(const Pose& motion, const Eigen::Quaterniond& turn) {
    return {turn * motion.rotation * turn.conjugate(), turn * motion.translation};
}

// Seen in a mirror that reverses one axis.
Pose mirrored(const Pose& motion, int axis) {
    Eigen::Matrix3d mirror = Eigen::Matrix3d::Identity();
    mirror(axis, axis) = -1.0;
    return Pose::from_matrix(mirror * motion.rotation_matrix() * mirror, mirror * motion.translation);
}

Pose scaled(const Pose& motion, double factor) {
    return {motion.rotation, factor * motion.translation};
}

Eigen::Quaterniond about_axis(double degrees) {
    return Eigen::Quaterniond(Eigen::AngleAxisd(degrees * kPi / 180.0, Eigen::Vector3d::UnitZ()));
}

Pose corrected(MotionMistake mistake, const Pose& motion, const Eigen::Quaterniond& best_turn) {
    switch (mistake) {
        case MotionMistake::kNone:
            return motion;
        case MotionMistake::kInverted:
            return motion.inverse();
        case MotionMistake::kTurned90:
            return turned(motion, about_axis(90.0));
        case MotionMistake::kTurned180:
            return turned(motion, about_axis(180.0));
        case MotionMistake::kTurned270:
            return turned(motion, about_axis(270.0));
        case MotionMistake::kMirrored:
            return mirrored(motion, 0);
        case MotionMistake::kFlipped:
            return mirrored(motion, 1);
        case MotionMistake::kMillimetres:
            return scaled(motion, 1e-3);
        case MotionMistake::kMetres:
            return scaled(motion, 1e3);
        case MotionMistake::kTurned:
            return turned(motion, best_turn);
    }
    return motion;
}

double length(const Twist& twist, double radius_m) {
    return std::hypot(twist.tail<3>().norm(), radius_m * twist.head<3>().norm());
}

// By how much a motion misses the present sighting, as a share of how far the part moved in the camera's frame.
double off_share(const Pair& pair, const Pose& motion, const Eigen::Vector3d& centre, double radius_m) {
    const Pose& before = pair.before.camera_from_object;
    const Pose& now = pair.now.camera_from_object;
    const double moved_m = length(twist_about(before, now, centre), radius_m);
    return length(twist_about(motion * before, now, centre), radius_m) / std::max(moved_m, 1e-12);
}

double median_off(const std::vector<Pair>& pairs, MotionMistake mistake, const Eigen::Quaterniond& best_turn,
                  const Eigen::Vector3d& centre, double radius_m) {
    std::vector<double> shares;
    for (const Pair& pair : pairs)
        shares.push_back(off_share(pair, corrected(mistake, pair.now_from_before, best_turn), centre, radius_m));
    const auto middle = shares.begin() + static_cast<std::ptrdiff_t>(shares.size() / 2);
    std::nth_element(shares.begin(), middle, shares.end());
    return *middle;
}

// The turn that takes the arm's motions to those of the image, by their rotations and shifts (Kabsch 1976).
Eigen::Quaterniond best_turn(const std::vector<Pair>& pairs, double radius_m) {
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (const Pair& pair : pairs) {
        const Twist seen = log(pair.now.camera_from_object * pair.before.camera_from_object.inverse());
        const Twist given = log(pair.now_from_before);
        sum += seen.tail<3>() * given.tail<3>().transpose() +
               radius_m * radius_m * seen.head<3>() * given.head<3>().transpose();
    }
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Eigen::Matrix3d sign = Eigen::Matrix3d::Identity();
    sign(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant();
    return Eigen::Quaterniond(Eigen::Matrix3d(svd.matrixU() * sign * svd.matrixV().transpose()));
}

// Where the part moved clearly in the camera's frame.
std::vector<Pair> pairs_of(const std::vector<Sighting>& sightings, const Eigen::Vector3d& centre, double radius_m,
                           const ArmMotionOptions& options) {
    std::vector<Pair> pairs;
    for (std::size_t k = sightings.size(); k-- > 1 && static_cast<int>(pairs.size()) < options.pairs;) {
        const Sighting& before = sightings[k - 1];
        const Sighting& now = sightings[k];
        if (now.other_mode) continue;
        const double moved_m = length(twist_about(before.camera_from_object, now.camera_from_object, centre), radius_m);
        const Matrix6d sum = before.covariance + now.covariance;
        const double sigma_m =
            std::sqrt(sum.bottomRightCorner<3, 3>().trace() + radius_m * radius_m * sum.topLeftCorner<3, 3>().trace());
        if (moved_m < options.min_motion_sigmas * sigma_m) continue;
        pairs.push_back({before, now, now.arm_from_camera.inverse() * before.arm_from_camera});
    }
    return pairs;
}

}  // namespace

const char* to_string(MotionMistake mistake) {
    switch (mistake) {
        case MotionMistake::kNone:
            return "as the arm says";
        case MotionMistake::kInverted:
            return "as if the camera's motion were inverted";
        case MotionMistake::kTurned90:
            return "as if the image were turned by 90 degrees";
        case MotionMistake::kTurned180:
            return "as if the image were turned by 180 degrees";
        case MotionMistake::kTurned270:
            return "as if the image were turned by 270 degrees";
        case MotionMistake::kMirrored:
            return "as if the image's columns were mirrored";
        case MotionMistake::kFlipped:
            return "as if the image's rows were mirrored";
        case MotionMistake::kMillimetres:
            return "as if the camera's translation were given in m where mm belong";
        case MotionMistake::kMetres:
            return "as if the camera's translation were given in mm where m belong";
        case MotionMistake::kTurned:
            return "as if the arm's frame were turned against the camera's";
    }
    return "";
}

void validate(const ArmMotionOptions& options) {
    check_option("arm_motion.pairs", options.pairs, 1, 1000);
    check_option("arm_motion.min_pairs", options.min_pairs, 1, 1000);
    check_option("arm_motion.min_motion_sigmas", options.min_motion_sigmas, 0.0, 1e6);
    check_option("arm_motion.off_share", options.off_share, 0.0, 1e6);
    check_option("arm_motion.explained_share", options.explained_share, 0.0, 1.0);
}

ArmMotion compare_motions(const std::vector<Sighting>& sightings, const Eigen::Vector3d& centre_in_object,
                          double radius_m, const ArmMotionOptions& options) {
    const std::vector<Pair> pairs = pairs_of(sightings, centre_in_object, radius_m, options);
    ArmMotion motion;
    motion.pairs = static_cast<int>(pairs.size());
    if (motion.pairs < options.min_pairs) return motion;
    motion.off_share =
        median_off(pairs, MotionMistake::kNone, Eigen::Quaterniond::Identity(), centre_in_object, radius_m);
    if (motion.off_share < options.off_share) return motion;
    const Eigen::Quaterniond turn = best_turn(pairs, radius_m);
    double least = options.explained_share * motion.off_share;
    for (int k = 1; k < kNumMotionMistakes; ++k) {
        const auto mistake = static_cast<MotionMistake>(k);
        // A turn that fits best explains more than one that is given: it must be better by as much again.
        const double handicap = mistake == MotionMistake::kTurned ? 2.0 : 1.0;
        const double off = handicap * median_off(pairs, mistake, turn, centre_in_object, radius_m);
        if (off >= least) continue;
        least = off;
        motion.mistake = mistake;
    }
    return motion;
}

}  // namespace nearpose
