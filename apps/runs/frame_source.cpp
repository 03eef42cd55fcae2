#include "apps/runs/frame_source.hpp"

#include <cmath>
#include <set>
#include <stdexcept>
#include <utility>

#include "apps/base/number_text.hpp"
#include "apps/data_set/bop_masks.hpp"
#include "apps/data_set/camera_json.hpp"
#include "apps/data_set/image_files.hpp"
#include "apps/data_set/point_cloud_file.hpp"
#include "apps/runs/input_doubts.hpp"

namespace nearpose::program {
namespace {

class BopSource : public FrameSource {
  public:
    BopSource(const std::filesystem::path& folder, const data_set::SceneOptions& options, const MaskOptions& masks)
        : scene_(data_set::open_scene(folder, options)), first_mask_only_(masks.first_frame_only) {
        scene_id_ = scene_.id;
        notices_ = scene_.notices;
        time_notices_ = scene_.time_notices;
        for (const data_set::Frame& frame : scene_.frames) {
            frames_.push_back({frame.id, frame.stamp_s, frame.camera, frame.camera_from_world});
            const std::string doubt = camera_doubt(frame.camera);
            if (!doubt.empty()) notices_.add(frame.id, (folder / "scene_camera.json").string() + ": " + doubt);
        }
        if (!masks.use) return;
        masks_.emplace(scene_, masks.object_id, masks.index);
        has_masks_ = masks_->available();
        if (!has_masks_) {
            notices_.add(0,
                         folder.string() + ": no mask_visib folder; every measured point in range may be the object");
        }
    }

    FrameData load(std::size_t index) const override {
        const data_set::Frame& frame = scene_.frames[index];
        FrameData data;
        data.depth = data_set::load_depth(frame);
        if (!masks_ || (first_mask_only_ && index > 0)) return data;
        data_set::FrameMask mask = masks_->load(frame);
        data.mask = std::move(mask.mask);
        if (!mask.notice.empty()) data.notices.push_back(mask.notice);
        const std::string doubt = data.mask ? mask_doubt(data.depth, *data.mask) : std::string();
        if (!doubt.empty()) data.notices.push_back(doubt);
        return data;
    }

  private:
    data_set::BopScene scene_;
    std::optional<data_set::MaskSource> masks_;
    bool first_mask_only_;
};

std::vector<int> cloud_numbers(const std::vector<std::filesystem::path>& files) {
    std::vector<int> numbers;
    for (const std::filesystem::path& file : files) {
        const std::optional<int> number = data_set::trailing_number(file);
        if (!number || (!numbers.empty() && *number <= numbers.back())) {
            numbers.clear();
            for (std::size_t i = 0; i < files.size(); ++i) numbers.push_back(static_cast<int>(i));
            return numbers;
        }
        numbers.push_back(*number);
    }
    return numbers;
}

// The nearest point in each pixel.
DepthImage project(const std::vector<Eigen::Vector3f>& points_in_camera, const PinholeCamera& camera) {
    DepthImage depth{camera.width, camera.height, {}};
    depth.depth_m.assign(static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height), 0.0F);
    for (const Eigen::Vector3f& point : points_in_camera) {
        if (!(point.z() > 0.0F)) continue;
        const Eigen::Vector2d uv = camera.project(point.cast<double>());
        const int pixel = camera.pixel_at(uv.x(), uv.y());
        if (pixel < 0) continue;
        float& value_m = depth.depth_m[static_cast<std::size_t>(pixel)];
        if (value_m == 0.0F || point.z() < value_m) value_m = point.z();
    }
    return depth;
}

class CloudSource : public FrameSource {
  public:
    CloudSource(const std::filesystem::path& folder, const std::filesystem::path& camera_json,
                const data_set::SceneOptions& options, bool segmented)
        : camera_(data_set::read_camera_json(camera_json).camera), segmented_(segmented) {
        const std::vector<std::filesystem::path> files = data_set::list_clouds(folder);
        const std::vector<int> numbers = cloud_numbers(files);
        for (std::size_t i = 0; i < files.size(); ++i) {
            if (options.first_frame && numbers[i] < *options.first_frame) continue;
            if (options.last_frame && numbers[i] > *options.last_frame) continue;
            frames_.push_back({numbers[i], numbers[i] / options.frames_per_second, camera_, std::nullopt});
            files_.push_back(files[i]);
        }
        if (frames_.empty()) throw std::runtime_error(folder.string() + ": no frame between --first and --last");
        scene_id_ = options.scene_id.value_or(0);
    }

    FrameData load(std::size_t index) const override {
        FrameData data;
        const data_set::CloudFile cloud = data_set::read_cloud(files_[index]);
        for (const Eigen::Vector3f& point : cloud.points_in_camera) {
            if (point.allFinite() && point.z() > 0.0F) data.points_in_camera.push_back(point);
        }
        if (data.points_in_camera.empty()) {
            throw std::runtime_error(files_[index].string() + ": no point lies in front of the camera");
        }
        if (!segmented_) data.depth = project(data.points_in_camera, camera_);
        return data;
    }

  private:
    PinholeCamera camera_;
    bool segmented_;
    std::vector<std::filesystem::path> files_;
};

}  // namespace

std::unique_ptr<FrameSource> open_bop_source(const std::filesystem::path& scene, const data_set::SceneOptions& options,
                                             const MaskOptions& masks) {
    return std::make_unique<BopSource>(scene, options, masks);
}

std::unique_ptr<FrameSource> open_cloud_source(const std::filesystem::path& folder,
                                               const std::filesystem::path& camera_json,
                                               const data_set::SceneOptions& options, bool segmented) {
    return std::make_unique<CloudSource>(folder, camera_json, options, segmented);
}

Observation observe_frame(const FrameInfo& frame, FrameData data) {
    if (!data.depth.depth_m.empty()) return make_observation(std::move(data.depth), frame.camera, data.mask);
    if (!data.points_in_camera.empty()) return make_observation(data.points_in_camera, frame.camera);
    return make_observation(project({}, frame.camera), frame.camera, std::nullopt);
}

}  // namespace nearpose::program
