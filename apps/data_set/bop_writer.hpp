// Writes BOP scenes; for simulated scenes and imported recordings. Numbers are written with the shortest text that
// reads back as the same double; each file is written whole.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <vector>

#include "core/base/camera.hpp"
#include "core/base/depth_image.hpp"
#include "core/base/pose.hpp"

namespace nearpose::data_set {

// A box of pixels as BOP writes it; all -1 where nothing is visible.
struct BopBox {
    int u = -1, v = -1, width = -1, height = -1;  // [pixels]
};

// An object's entry in scene_gt.json and scene_gt_info.json.
struct ObjectTruth {
    int object_id = 1;
    Pose camera_from_object;
    int silhouette_pixels = 0;  // px_count_all: of the whole silhouette, also outside the image
    int measured_pixels = 0;    // px_count_valid: of the silhouette, with a depth measurement
    int visible_pixels = 0;     // px_count_visib
    BopBox silhouette_box;      // bbox_obj: of the whole silhouette, also outside the image
    BopBox visible_box;         // bbox_visib
};

struct FrameRecord {
    int id = 0;
    PinholeCamera camera;
    double depth_scale_mm = 1.0;  // millimetres per count
    std::optional<Pose> camera_from_world;
    std::optional<double> timestamp_s;
    std::vector<ObjectTruth> objects;  // in the order of the mask files
};

struct TestTarget {
    int scene_id = 0;
    int image_id = 0;
    int object_id = 0;
    int instance_count = 1;
};

// All throw std::runtime_error naming the file where it cannot be written, std::invalid_argument for numbers that are
// not finite.
void write_scene_camera(const std::filesystem::path& path, const std::vector<FrameRecord>& frames);
void write_scene_gt(const std::filesystem::path& path, const std::vector<FrameRecord>& frames);
void write_scene_gt_info(const std::filesystem::path& path, const std::vector<FrameRecord>& frames);
void write_test_targets(const std::filesystem::path& path, const std::vector<TestTarget>& targets);

// From the first of the mask's pixels to the last, all -1 for an empty mask. As bop_toolkit writes it, a box one pixel
// wide has the width 0.
BopBox box_of(const Mask& mask);

// The folder of one scene: images are written as they come, the JSON files by finish(), so that a scene that was cut
// short has no scene_camera.json and cannot be taken for a whole one.
class BopSceneWriter {
  public:
    // `scene_folder` is <set>/test/<scene>, so that camera.json is ../../camera.json. Creates the folders. Throws
    // std::runtime_error where the folder is a scene already: frames of two recordings would mix.
    explicit BopSceneWriter(const std::filesystem::path& scene_folder);

    // The depth is written with the record's scale. `visible_masks` and `masks` (whole silhouettes) are parallel to
    // record.objects, or empty where there are none.
    void add_frame(const FrameRecord& record, const DepthImage& depth, const std::vector<Mask>& visible_masks = {},
                   const std::vector<Mask>& masks = {});
    // For depth whose file the caller writes itself, to depth_path(scene_folder, record.id).
    void add_frame(const FrameRecord& record);

    // Writes scene_camera.json, ../../camera.json where there is none yet and, where records have objects,
    // scene_gt.json and scene_gt_info.json.
    void finish() const;

    const std::vector<FrameRecord>& frames() const { return frames_; }

  private:
    std::filesystem::path folder_;
    std::vector<FrameRecord> frames_;
};

}  // namespace nearpose::data_set
