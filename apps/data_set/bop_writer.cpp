#include "apps/data_set/bop_writer.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <string>

#include "apps/base/file_io.hpp"
#include "apps/base/number_text.hpp"
#include "apps/data_set/bop_scene.hpp"
#include "apps/data_set/camera_json.hpp"
#include "apps/data_set/png_file.hpp"

namespace nearpose::data_set {
namespace {

namespace fs = std::filesystem;

std::string finite(double value) {
    if (!std::isfinite(value)) throw std::invalid_argument("a number of the scene is not finite");
    return format_number(value);
}

std::string rotation_text(const Pose& pose) {
    const Eigen::Matrix3d R = pose.rotation_matrix();
    std::string text;
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) text += (text.empty() ? "[" : ", ") + finite(R(row, column));
    }
    return text + "]";
}

std::string millimetres_text(const Eigen::Vector3d& v) {
    return "[" + finite(v.x() * 1e3) + ", " + finite(v.y() * 1e3) + ", " + finite(v.z() * 1e3) + "]";
}

std::string camera_entry(const FrameRecord& frame) {
    const PinholeCamera& camera = frame.camera;
    std::string text = "{\"cam_K\": [" + finite(camera.fx) + ", 0.0, " + finite(camera.cx) + ", 0.0, " +
                       finite(camera.fy) + ", " + finite(camera.cy) + ", 0.0, 0.0, 1.0]";
    if (frame.camera_from_world) {
        text += ", \"cam_R_w2c\": " + rotation_text(*frame.camera_from_world) +
                ", \"cam_t_w2c\": " + millimetres_text(frame.camera_from_world->translation);
    }
    text += ", \"depth_scale\": " + finite(frame.depth_scale_mm);
    if (frame.timestamp_s) text += ", \"timestamp\": " + finite(*frame.timestamp_s);
    return text + "}";
}

std::string truth_entry(const ObjectTruth& object) {
    return "{\"cam_R_m2c\": " + rotation_text(object.camera_from_object) +
           ", \"cam_t_m2c\": " + millimetres_text(object.camera_from_object.translation) +
           ", \"obj_id\": " + std::to_string(object.object_id) + "}";
}

std::string box_text(const BopBox& box) {
    return "[" + std::to_string(box.u) + ", " + std::to_string(box.v) + ", " + std::to_string(box.width) + ", " +
           std::to_string(box.height) + "]";
}

std::string info_entry(const ObjectTruth& object) {
    const double fraction =
        object.silhouette_pixels > 0 ? static_cast<double>(object.visible_pixels) / object.silhouette_pixels : 0.0;
    const BopBox silhouette_box = object.visible_pixels > 0 ? object.silhouette_box : BopBox{};  // as bop_toolkit
    return "{\"bbox_obj\": " + box_text(silhouette_box) + ", \"bbox_visib\": " + box_text(object.visible_box) +
           ", \"px_count_all\": " + std::to_string(object.silhouette_pixels) +
           ", \"px_count_valid\": " + std::to_string(object.measured_pixels) +
           ", \"px_count_visib\": " + std::to_string(object.visible_pixels) + ", \"visib_fract\": " + finite(fraction) +
           "}";
}

// One line a frame, as BOP's own files have it.
void write_frames(const fs::path& path, const std::vector<FrameRecord>& frames,
                  const std::function<std::string(const FrameRecord&)>& entry) {
    std::string text = "{";
    for (const FrameRecord& frame : frames) {
        text += (text.size() == 1 ? "\n  \"" : ",\n  \"") + std::to_string(frame.id) + "\": " + entry(frame);
    }
    write_file_atomically(path, text + "\n}\n");
}

void write_object_lists(const fs::path& path, const std::vector<FrameRecord>& frames,
                        std::string (*entry)(const ObjectTruth&)) {
    write_frames(path, frames, [&](const FrameRecord& frame) {
        std::string text;
        for (const ObjectTruth& object : frame.objects) text += (text.empty() ? "" : ", ") + entry(object);
        return "[" + text + "]";
    });
}

void write_masks(const fs::path& folder, const FrameRecord& record, const std::vector<Mask>& masks, bool visible_part) {
    if (masks.empty()) return;
    if (masks.size() != record.objects.size()) {
        throw std::invalid_argument("frame " + std::to_string(record.id) + ": masks and objects differ in number");
    }
    for (std::size_t i = 0; i < masks.size(); ++i) {
        const fs::path path = mask_path(folder, record.id, static_cast<int>(i), visible_part);
        create_folder(path.parent_path());
        write_mask_png(path, masks[i]);
    }
}

}  // namespace

void write_scene_camera(const fs::path& path, const std::vector<FrameRecord>& frames) {
    write_frames(path, frames, camera_entry);
}

void write_scene_gt(const fs::path& path, const std::vector<FrameRecord>& frames) {
    write_object_lists(path, frames, truth_entry);
}

void write_scene_gt_info(const fs::path& path, const std::vector<FrameRecord>& frames) {
    write_object_lists(path, frames, info_entry);
}

void write_test_targets(const fs::path& path, const std::vector<TestTarget>& targets) {
    std::string text = "[";
    for (const TestTarget& target : targets) {
        text += (text.size() == 1 ? "\n  {" : ",\n  {");
        text += "\"im_id\": " + std::to_string(target.image_id) +
                ", \"inst_count\": " + std::to_string(target.instance_count) +
                ", \"obj_id\": " + std::to_string(target.object_id) +
                ", \"scene_id\": " + std::to_string(target.scene_id) + "}";
    }
    write_file_atomically(path, text + "\n]\n");
}

BopBox box_of(const Mask& mask) {
    int first_u = mask.width, first_v = mask.height, last_u = -1, last_v = -1;
    for (int v = 0; v < mask.height; ++v) {
        for (int u = 0; u < mask.width; ++u) {
            if (mask.value[static_cast<std::size_t>(v) * mask.width + u] == 0) continue;
            first_u = std::min(first_u, u);
            last_u = std::max(last_u, u);
            first_v = std::min(first_v, v);
            last_v = std::max(last_v, v);
        }
    }
    if (last_u < 0) return {};
    return {first_u, first_v, last_u - first_u, last_v - first_v};
}

BopSceneWriter::BopSceneWriter(const fs::path& scene_folder) : folder_(scene_folder) {
    if (fs::exists(folder_ / "scene_camera.json")) {
        throw std::runtime_error(folder_.string() + ": is a scene already; choose a folder that is new");
    }
    create_folder(folder_ / "depth");
}

void BopSceneWriter::add_frame(const FrameRecord& record, const DepthImage& depth,
                               const std::vector<Mask>& visible_masks, const std::vector<Mask>& masks) {
    if (depth.width != record.camera.width || depth.height != record.camera.height) {
        throw std::invalid_argument("frame " + std::to_string(record.id) + ": depth and camera differ in size");
    }
    write_depth_png(depth_path(folder_, record.id), depth, record.depth_scale_mm);
    write_masks(folder_, record, visible_masks, true);
    write_masks(folder_, record, masks, false);
    add_frame(record);
}

void BopSceneWriter::add_frame(const FrameRecord& record) {
    if (!frames_.empty() && record.id <= frames_.back().id) {
        throw std::invalid_argument("frame " + std::to_string(record.id) + ": frame numbers must grow");
    }
    const fs::path camera_file = camera_json_path(folder_);
    if (frames_.empty() && fs::exists(camera_file)) {
        const PinholeCamera other = read_camera_json(camera_file).camera;
        if (other.width != record.camera.width || other.height != record.camera.height) {
            throw std::runtime_error(camera_file.string() +
                                     ": is of a camera of another image size; scenes of one data "
                                     "set share their camera");
        }
    }
    frames_.push_back(record);
}

void BopSceneWriter::finish() const {
    if (frames_.empty()) throw std::invalid_argument(folder_.string() + ": a scene needs at least one frame");
    const auto has_objects = [](const FrameRecord& frame) { return !frame.objects.empty(); };
    if (std::any_of(frames_.begin(), frames_.end(), has_objects)) {
        write_scene_gt(folder_ / "scene_gt.json", frames_);
        write_scene_gt_info(folder_ / "scene_gt_info.json", frames_);
    }
    // One that is there may be the user's own, or of the set's other scenes.
    const fs::path camera_file = camera_json_path(folder_);
    if (!fs::exists(camera_file)) {
        write_camera_json(camera_file, frames_.front().camera, frames_.front().depth_scale_mm);
    }
    write_scene_camera(folder_ / "scene_camera.json", frames_);  // last: its presence says that the scene is whole
}

}  // namespace nearpose::data_set
