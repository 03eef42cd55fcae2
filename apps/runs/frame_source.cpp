#include "apps/runs/frame_source.hpp"

#include <cmath>
#include <set>
#include <stdexcept>
#include <utility>

#include "apps/base/number_text.hpp"
#include "apps/data_set/bop_masks.hpp"
#include "apps/data_set/camera_json.hpp"
#include "apps/data_set/point_cloud_file.hpp"

namespace nearpose::program {
namespace {

bool has_measurement(const DepthImage& depth) {
    for (const float value_m : depth.depth_m) {
        if (value_m > 0.0F) return true;
    }
    return false;
}

class BopSource : public FrameSource {
  public:
    BopSource(const std::filesystem::path& folder, const data_set::SceneOptions& options, const MaskOptions& masks)
        : scene_(data_set::open_scene(folder, options)) {
        scene_id_ = scene_.id;
        for (const data_set::Frame& frame : scene_.frames) {
            frames_.push_back({frame.id, frame.stamp_s, frame.camera, frame.camera_from_world});
        }
        if (!masks.use) return;
        masks_.emplace(scene_, masks.object_id, masks.index);
        if (!masks_->available()) {
            notice_ = folder.string() + ": no mask_visib folder; every measured point in range may be the object";
        }
    }

    FrameData load(std::size_t index) const override {
        const data_set::Frame& frame = scene_.frames[index];
        FrameData data;
        data.depth = data_set::load_depth(frame);
        if (!has_measurement(data.depth)) throw std::runtime_error(frame.depth.string() + ": no pixel has a depth");
        if (masks_) data.mask = masks_->load(frame);
        return data;
    }

  private:
    data_set::BopScene scene_;
    std::optional<data_set::MaskSource> masks_;
};

// The number that a file's name ends in.
std::optional<int> trailing_number(const std::filesystem::path& path) {
    const std::string name = path.stem().string();
    const std::size_t last = name.find_last_not_of("0123456789");
    const auto number = data_set::parse_integer(name.substr(last == std::string::npos ? 0 : last + 1));
    if (!number || *number > 1'000'000'000) return std::nullopt;
    return static_cast<int>(*number);
}

std::vector<int> cloud_numbers(const std::vector<std::filesystem::path>& files) {
    std::vector<int> numbers;
    for (const std::filesystem::path& file : files) {
        const std::optional<int> number = trailing_number(file);
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
