#include "apps/set_up/corrected_source.hpp"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

namespace nearpose::program {
namespace {

struct StampedPose {
    double stamp_s;
    Pose given_from_world;
};

// Nothing where their times do not increase.
std::vector<StampedPose> poses_in_time(const std::vector<FrameInfo>& frames) {
    std::vector<StampedPose> poses;
    for (const FrameInfo& frame : frames) {
        if (!frame.camera_from_world) continue;
        if (!poses.empty() && frame.stamp_s <= poses.back().stamp_s) return {};
        poses.push_back({frame.stamp_s, *frame.camera_from_world});
    }
    return poses;
}

// `poses` are at least two.
Pose pose_at(const std::vector<StampedPose>& poses, double stamp_s) {
    const auto later = std::upper_bound(poses.begin() + 1, poses.end() - 1, stamp_s,
                                        [](double stamp, const StampedPose& pose) { return stamp < pose.stamp_s; });
    const StampedPose &before = *(later - 1), &after = *later;
    const double fraction = (stamp_s - before.stamp_s) / (after.stamp_s - before.stamp_s);
    return interpolate(before.given_from_world, after.given_from_world, fraction);
}

class CorrectedSource : public FrameSource {
  public:
    CorrectedSource(std::shared_ptr<const FrameSource> given, const SetupErrors& errors)
        : given_(std::move(given)), depth_factor_(static_cast<float>(1.0 / (1.0 + errors.depth_scale))) {
        scene_id_ = given_->scene_id();
        frames_ = given_->frames();
        notices_ = given_->notices();
        time_notices_ = given_->time_notices();
        has_masks_ = given_->has_masks();
        const std::vector<StampedPose> poses =
            errors.time_offset_s == 0.0 ? std::vector<StampedPose>{} : poses_in_time(frames_);
        for (FrameInfo& frame : frames_) {
            frame.camera = corrected(frame.camera, errors);
            if (!frame.camera_from_world) continue;
            if (poses.size() > 1) frame.camera_from_world = pose_at(poses, frame.stamp_s - errors.time_offset_s);
            frame.camera_from_world = corrected(*frame.camera_from_world, errors);
        }
    }

    FrameData load(std::size_t index) const override {
        FrameData data = given_->load(index);
        if (depth_factor_ == 1.0F) return data;
        for (float& depth_m : data.depth.depth_m) depth_m *= depth_factor_;
        for (Eigen::Vector3f& point : data.points_in_camera) point *= depth_factor_;
        return data;
    }

  private:
    std::shared_ptr<const FrameSource> given_;
    float depth_factor_;
};

}  // namespace

std::unique_ptr<FrameSource> corrected_source(std::shared_ptr<const FrameSource> given, const SetupErrors& errors) {
    return std::make_unique<CorrectedSource>(std::move(given), errors);
}

double usual_step_s(const FrameSource& source) {
    std::vector<double> steps_s;
    for (std::size_t k = 1; k < source.frames().size(); ++k) {
        const double step_s = source.frames()[k].stamp_s - source.frames()[k - 1].stamp_s;
        if (step_s > 0.0) steps_s.push_back(step_s);
    }
    if (steps_s.empty()) return 0.0;
    const auto middle = steps_s.begin() + static_cast<std::ptrdiff_t>(steps_s.size() / 2);
    std::nth_element(steps_s.begin(), middle, steps_s.end());
    return *middle;
}

}  // namespace nearpose::program
