#include "apps/pose_error.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace nearpose::program {
namespace {

using Corners = std::array<Eigen::Vector3d, 8>;

Corners box_corners(const data_set::ModelInfo& model) {
    Corners corners;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const Eigen::Vector3d& low = model.box_min_in_object_m;
        const Eigen::Vector3d& high = model.box_max_in_object_m;
        corners[i] = {(i & 1U ? high : low).x(), (i & 2U ? high : low).y(), (i & 4U ? high : low).z()};
    }
    return corners;
}

double largest_distance_m(const Corners& corners, const Pose& a, const Pose& b) {
    double largest = 0.0;
    for (const Eigen::Vector3d& corner : corners) largest = std::max(largest, (a * corner - b * corner).norm());
    return largest;
}

// The turn about the symmetry's axis by `angle_rad`: object_from_object.
Pose turn(const data_set::ContinuousSymmetry& symmetry, double angle_rad) {
    const Eigen::Quaterniond rotation(Eigen::AngleAxisd(angle_rad, symmetry.axis_in_object));
    return {rotation, symmetry.offset_in_object_m - rotation * symmetry.offset_in_object_m};
}

// The true pose, turned about the axis to where it is nearest to `estimated`: the best of some samples, then golden
// sections around it.
Pose nearest_turn(const data_set::ContinuousSymmetry& symmetry, const Corners& corners, const Pose& estimated,
                  const Pose& truth) {
    constexpr int kSamples = 360;
    constexpr int kSections = 60;
    constexpr double kStep_rad = 2.0 * std::numbers::pi / kSamples;
    const auto cost = [&](double angle_rad) {
        return largest_distance_m(corners, estimated, truth * turn(symmetry, angle_rad));
    };
    int best = 0;
    for (int i = 1; i < kSamples; ++i) {
        if (cost(i * kStep_rad) < cost(best * kStep_rad)) best = i;
    }
    double low = (best - 1) * kStep_rad, high = (best + 1) * kStep_rad;
    const double golden = 1.0 / std::numbers::phi;
    for (int i = 0; i < kSections; ++i) {
        const double left = high - golden * (high - low), right = low + golden * (high - low);
        if (cost(left) < cost(right)) {
            high = right;
        } else {
            low = left;
        }
    }
    return truth * turn(symmetry, 0.5 * (low + high));
}

bool within(const FrameError& frame, const ErrorLimit& limit) {
    return frame.error && frame.error->translation_m <= limit.translation_m &&
           frame.error->rotation_rad <= limit.rotation_rad;
}

}  // namespace

PoseError pose_error(const Pose& estimated_camera_from_object, const Pose& true_camera_from_object,
                     const data_set::ModelInfo& model) {
    const Corners corners = box_corners(model);
    std::vector<Pose> equals = {true_camera_from_object};
    for (const Pose& symmetry : model.discrete_symmetries) equals.push_back(true_camera_from_object * symmetry);
    if (!model.continuous_symmetries.empty()) {
        std::vector<Pose> turned;
        for (const Pose& pose : equals) {
            for (const data_set::ContinuousSymmetry& symmetry : model.continuous_symmetries) {
                turned.push_back(nearest_turn(symmetry, corners, estimated_camera_from_object, pose));
            }
        }
        equals = std::move(turned);
    }
    const Pose* nearest = nullptr;
    double least_m = std::numeric_limits<double>::infinity();
    for (const Pose& pose : equals) {
        const double distance_m = largest_distance_m(corners, estimated_camera_from_object, pose);
        if (nearest == nullptr || distance_m < least_m) {
            nearest = &pose;
            least_m = distance_m;
        }
    }
    const Eigen::Vector3d centre_in_object = 0.5 * (model.box_min_in_object_m + model.box_max_in_object_m);
    return {(estimated_camera_from_object * centre_in_object - *nearest * centre_in_object).norm(),
            angle_between(estimated_camera_from_object.rotation, nearest->rotation)};
}

ErrorStatistics statistics_of(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    const auto percentile = [&](double fraction) {
        const double rank = fraction * static_cast<double>(values.size() - 1);
        const auto below = static_cast<std::size_t>(rank);
        const std::size_t above = std::min(below + 1, values.size() - 1);
        return std::lerp(values[below], values[above], rank - static_cast<double>(below));
    };
    double sum = 0.0;
    for (const double value : values) sum += value;
    return {sum / static_cast<double>(values.size()), percentile(0.5), percentile(0.95), values.back()};
}

std::optional<int> holds_from(const std::vector<FrameError>& frames, const ErrorLimit& limit) {
    std::optional<int> first;
    for (const FrameError& frame : frames) {
        if (!within(frame, limit)) {
            first.reset();
        } else if (!first) {
            first = frame.frame_id;
        }
    }
    return first;
}

std::optional<int> arrives_at(const std::vector<FrameError>& frames, const ErrorLimit& limit) {
    for (const FrameError& frame : frames) {
        if (within(frame, limit)) return frame.frame_id;
    }
    return std::nullopt;
}

}  // namespace nearpose::program
