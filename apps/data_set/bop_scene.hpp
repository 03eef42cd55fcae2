// A BOP scene: <set>/test/<scene>/{scene_camera.json, depth/NNNNNN.png, mask_visib/NNNNNN_KKKKKK.png}. Ground truth is
// not read here: see bop_masks.hpp for the one number that is, and bop_ground_truth.hpp for evaluation.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "apps/base/notices.hpp"
#include "apps/data_set/json_file.hpp"
#include "core/base/camera.hpp"
#include "core/base/depth_image.hpp"
#include "core/base/pose.hpp"

namespace nearpose::data_set {

struct Frame {
    int id = 0;  // the frame's number in scene_camera.json
    PinholeCamera camera;
    double depth_scale_mm = 1.0;            // millimetres per count
    bool has_depth_scale = true;            // false: the file has none, and depth_scale_mm is what BOP takes then
    std::optional<Pose> camera_from_world;  // the measured camera motion
    double stamp_s = 0.0;                   // acquisition; the key "timestamp", else frame number / frames per second
    std::filesystem::path depth;  // of this number, whatever padding and ending; may be missing: load_depth tells
};

struct BopScene {
    std::filesystem::path folder;
    int id = 0;
    std::vector<Frame> frames;  // in numeric order; none is an error
    bool has_timestamps = false;
    Notices notices;       // what is odd about the files, and what was taken instead
    Notices time_notices;  // of the stamps
};

struct SceneOptions {
    std::optional<int> scene_id;      // else the number that the folder's name is, else 0
    double frames_per_second = 30.0;  // for scenes without timestamps
    std::optional<int> first_frame;   // frame numbers, both included
    std::optional<int> last_frame;
};

// Reads scene_camera.json and, for the image size, ../../camera.json or, where there is none, the headers of the depth
// images (the size that most of them have). Throws std::runtime_error naming file, frame and key where intrinsics are
// missing or no frame is left between first and last. Motions and stamps that cannot be used, and a missing
// depth_scale, are noted. Depth images are not read: a broken one concerns its frame only.
BopScene open_scene(const std::filesystem::path& folder, const SceneOptions& options = {});

// Throws std::runtime_error naming the file and the cause; the other frames are not concerned.
DepthImage load_depth(const Frame& frame);

// The control of frame `now` after frame `before`: T_now * T_before^-1 with T = camera_from_world, which maps
// coordinates in the camera of then to those in the camera of now. nullopt where either frame lacks its motion.
std::optional<Pose> now_from_before(const Frame& now, const Frame& before);

// Folder and file names of the layout.
std::filesystem::path depth_path(const std::filesystem::path& scene_folder, int frame_id);
std::filesystem::path mask_path(const std::filesystem::path& scene_folder, int frame_id, int mask_index,
                                bool visible_part = true);                          // mask_visib/, else mask/
std::filesystem::path camera_json_path(const std::filesystem::path& scene_folder);  // ../../camera.json

}  // namespace nearpose::data_set
