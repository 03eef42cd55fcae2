// Where the frames of an estimation come from: a BOP scene or a folder of point clouds.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/data_set/bop_scene.hpp"
#include "core/base/camera.hpp"
#include "core/base/pose.hpp"
#include "core/observation/observation.hpp"

namespace nearpose::program {

struct FrameInfo {
    int id = 0;
    double stamp_s = 0.0;
    PinholeCamera camera;
    std::optional<Pose> camera_from_world;  // the measured camera motion
};

// A frame's files, decoded: a depth image with or without a mask, or a cloud.
struct FrameData {
    DepthImage depth;
    std::optional<Mask> mask;
    std::vector<Eigen::Vector3f> points_in_camera;  // [m]; used where there is no depth image
    std::vector<std::string> notices;               // what is odd about the files, and what was taken instead
};

class FrameSource {
  public:
    virtual ~FrameSource() = default;

    int scene_id() const { return scene_id_; }
    const std::vector<FrameInfo>& frames() const { return frames_; }
    // What the user should know before the run, and at its end.
    const data_set::Notices& notices() const { return notices_; }
    const data_set::Notices& time_notices() const { return time_notices_; }
    bool has_masks() const { return has_masks_; }

    // Throws std::runtime_error naming the file and the cause; the other frames are not concerned.
    virtual FrameData load(std::size_t index) const = 0;

  protected:
    int scene_id_ = 0;
    std::vector<FrameInfo> frames_;
    data_set::Notices notices_, time_notices_;
    bool has_masks_ = false;
};

struct MaskOptions {
    bool use = true;
    int object_id = 1;
    std::optional<int> index;  // KKKKKK of the files; else from scene_gt.json, else 0
    bool first_frame_only = false;
};

std::unique_ptr<FrameSource> open_bop_source(const std::filesystem::path& scene, const data_set::SceneOptions& options,
                                             const MaskOptions& masks);

// Clouds in the camera's frame, one a file. A frame's number is the number that its file's name ends in where all
// names have one of their own, else its place. Points are the object's alone where `segmented`.
std::unique_ptr<FrameSource> open_cloud_source(const std::filesystem::path& folder,
                                               const std::filesystem::path& camera_json,
                                               const data_set::SceneOptions& options, bool segmented);

// The decoded frame as the estimator takes it. An empty FrameData gives an observation in which nothing is seen.
Observation observe_frame(const FrameInfo& frame, FrameData data);

}  // namespace nearpose::program
