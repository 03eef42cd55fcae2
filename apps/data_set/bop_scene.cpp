#include "apps/data_set/bop_scene.hpp"

#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>

#include "apps/base/number_text.hpp"
#include "apps/data_set/bop_pose.hpp"
#include "apps/data_set/bop_stamps.hpp"
#include "apps/data_set/camera_json.hpp"
#include "apps/data_set/depth_file.hpp"
#include "apps/data_set/image_files.hpp"
#include "apps/data_set/recording_hint.hpp"

namespace nearpose::data_set {
namespace {

namespace fs = std::filesystem;

int scene_number(const fs::path& folder, const SceneOptions& options, Notices& notices) {
    if (options.scene_id) return *options.scene_id;
    const std::string name = fs::weakly_canonical(folder).filename().string();  // also of "." and "scene/"
    const std::optional<std::int64_t> number = parse_integer(name);
    if (number && *number >= 0 && *number <= std::numeric_limits<int>::max()) return static_cast<int>(*number);
    notices.add(0, folder.string() + ": the folder's name is no number, so scene_id is 0; --scene-id gives another");
    return 0;
}

Frame read_frame(const fs::path& folder, int id, const JsonValue& entry, Notices& notices) {
    Frame frame;
    frame.id = id;
    if (!entry.find("cam_K")) throw entry.error("has no intrinsics: the key \"cam_K\" is missing");
    set_intrinsics(entry.at("cam_K"), frame.camera);
    refuse_distortion(entry);
    frame.has_depth_scale = entry.find("depth_scale").has_value();
    if (frame.has_depth_scale) {
        frame.depth_scale_mm = depth_scale_of(entry);
    } else {
        notices.add(id, entry
                            .error("has no depth_scale; 1.0 is taken, millimetres per count (for images of floating "
                                   "point numbers 1000: metres)")
                            .what());
    }
    frame.camera_from_world = read_motion(entry, id, notices);
    frame.depth = depth_path(folder, id);
    return frame;
}

// The size that most depth images have, by their headers; the first of those where several are as frequent. nullopt
// where none can be read.
std::optional<ImageSize> usual_size(const std::vector<Frame>& frames, const std::optional<ImageSize>& wanted) {
    std::vector<std::pair<ImageSize, int>> counts;
    for (const Frame& frame : frames) {
        ImageSize size;
        try {
            size = read_depth_size(frame.depth);
        } catch (const std::runtime_error&) {
            continue;  // a broken image is reported when its frame is read
        }
        if (wanted && size == *wanted) return wanted;
        auto found = counts.begin();
        while (found != counts.end() && !(found->first == size)) ++found;
        if (found == counts.end()) found = counts.insert(found, {size, 0});
        ++found->second;
    }
    std::optional<ImageSize> best;
    int best_count = 0;
    for (const auto& [size, count] : counts) {
        if (count <= best_count) continue;
        best = size;
        best_count = count;
    }
    return best;
}

ImageSize image_size(const fs::path& folder, const std::vector<Frame>& frames) {
    const fs::path camera_file = camera_json_path(folder);
    std::optional<ImageSize> wanted;
    if (fs::exists(camera_file)) {
        const PinholeCamera camera = read_camera_json(camera_file).camera;
        wanted = ImageSize{camera.width, camera.height};
    }
    const std::optional<ImageSize> found = usual_size(frames, wanted);
    if (!found && !wanted) {
        throw std::runtime_error((folder / "depth").string() +
                                 ": no depth image of the scene can be read, so the image size is not known; " +
                                 contents_of(folder / "depth"));
    }
    if (found && wanted && !(*found == *wanted)) {
        throw std::runtime_error(camera_file.string() + ": says " + std::to_string(wanted->width) + " x " +
                                 std::to_string(wanted->height) + " pixels, but the depth images have " +
                                 std::to_string(found->width) + " x " + std::to_string(found->height) +
                                 "; it must be of the depth stream at its recorded size");
    }
    return wanted ? *wanted : *found;
}

void check_options(const SceneOptions& options) {
    if (!(options.frames_per_second > 0.0) || !std::isfinite(options.frames_per_second)) {
        throw std::invalid_argument("frames per second is " + format_number(options.frames_per_second) +
                                    ", but must be positive");
    }
}

}  // namespace

fs::path depth_path(const fs::path& scene_folder, int frame_id) {
    return scene_folder / "depth" / (zero_padded(frame_id) + ".png");
}

fs::path mask_path(const fs::path& scene_folder, int frame_id, int mask_index, bool visible_part) {
    const std::string name = zero_padded(frame_id) + "_" + zero_padded(mask_index) + ".png";
    return scene_folder / (visible_part ? "mask_visib" : "mask") / name;
}

fs::path camera_json_path(const fs::path& scene_folder) {
    return fs::weakly_canonical(scene_folder).parent_path().parent_path() / "camera.json";
}

BopScene open_scene(const fs::path& folder, const SceneOptions& options) {
    check_options(options);
    const bool is_folder = fs::is_directory(folder);
    const std::string hint = fs::exists(folder / "scene_camera.json") ? std::string() : recording_hint(folder);
    if (!hint.empty() && fs::exists(folder)) throw std::runtime_error(folder.string() + ": " + hint);
    if (!is_folder) throw std::runtime_error(folder.string() + ": is not a folder");
    BopScene scene;
    scene.folder = folder;
    if (!fs::exists(folder / "scene_camera.json") && fs::is_directory(folder / "test")) {
        throw std::runtime_error(folder.string() + ": is a data set, not a scene; name one below " +
                                 (folder / "test").string());
    }
    const JsonFile file(folder / "scene_camera.json");
    const std::map<int, fs::path> images = depth_images_in(folder / "depth");
    std::vector<JsonValue> entries;
    for (const auto& [id, entry] : file.root().numbered_members()) {
        if (options.first_frame && id < *options.first_frame) continue;
        if (options.last_frame && id > *options.last_frame) continue;
        scene.frames.push_back(read_frame(folder, id, entry, scene.notices));
        if (const auto image = images.find(id); image != images.end()) scene.frames.back().depth = image->second;
        entries.push_back(entry);
    }
    if (scene.frames.empty()) throw file.root().error("has no frame in the range that was asked for");
    scene.has_timestamps = set_stamps(scene.frames, entries, options.frames_per_second, scene.time_notices);
    const ImageSize size = image_size(folder, scene.frames);
    for (Frame& frame : scene.frames) {
        frame.camera.width = size.width;
        frame.camera.height = size.height;
        validate(frame.camera);
    }
    scene.id = scene_number(folder, options, scene.notices);
    return scene;
}

DepthImage load_depth(const Frame& frame) {
    std::error_code ignored;
    if (!fs::exists(frame.depth, ignored)) {
        throw std::runtime_error(frame.depth.string() + ": No such file; " + contents_of(frame.depth.parent_path()));
    }
    const auto scale_mm = frame.has_depth_scale ? std::optional(frame.depth_scale_mm) : std::nullopt;
    return read_depth_file(frame.depth, scale_mm, {frame.camera.width, frame.camera.height});
}

std::optional<Pose> now_from_before(const Frame& now, const Frame& before) {
    if (!now.camera_from_world || !before.camera_from_world) return std::nullopt;
    return *now.camera_from_world * before.camera_from_world->inverse();
}

}  // namespace nearpose::data_set
