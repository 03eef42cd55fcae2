#include "apps/data_set/bop_scene.hpp"

#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>

#include "apps/base/number_text.hpp"
#include "apps/data_set/camera_json.hpp"
#include "apps/data_set/png_file.hpp"

namespace nearpose::data_set {
namespace {

namespace fs = std::filesystem;

// Files round rotations to a few digits; beyond this a matrix is a mistake, not a rounding.
constexpr double kRotationTolerance = 1e-3;

int scene_number(const fs::path& folder, const SceneOptions& options) {
    if (options.scene_id) return *options.scene_id;
    const std::string name = fs::weakly_canonical(folder).filename().string();  // also of "." and "scene/"
    const std::optional<std::int64_t> number = parse_integer(name);
    if (!number || *number < 0 || *number > std::numeric_limits<int>::max()) {
        throw std::runtime_error(folder.string() + ": the folder's name is no scene number; give one with --scene-id");
    }
    return static_cast<int>(*number);
}

// Throws where the measured motion is only half there: the control would silently be taken for none.
std::optional<Pose> read_motion(const JsonValue& entry) {
    const bool has_rotation = entry.find("cam_R_w2c").has_value();
    if (!has_rotation && !entry.find("cam_t_w2c")) return std::nullopt;
    return read_bop_pose(entry, "cam_R_w2c", "cam_t_w2c");
}

Frame read_frame(const fs::path& folder, int id, const JsonValue& entry) {
    Frame frame;
    frame.id = id;
    if (!entry.find("cam_K")) throw entry.error("has no intrinsics: the key \"cam_K\" is missing");
    set_intrinsics(entry.at("cam_K"), frame.camera);
    refuse_distortion(entry);
    frame.depth_scale_mm = depth_scale_of(entry);
    frame.camera_from_world = read_motion(entry);
    frame.depth = depth_path(folder, id);
    return frame;
}

double stamp_of(const JsonValue& entry) {
    if (!entry.find("timestamp"))
        throw entry.error("has no timestamp, but other frames have: give all of them or none");
    return entry.at("timestamp").number();
}

// Stamps either for all frames or for none, and growing: a time that jumps back would turn every motion round.
void set_stamps(std::vector<Frame>& frames, const std::vector<JsonValue>& entries, const SceneOptions& options,
                bool has_timestamps) {
    for (std::size_t i = 0; i < frames.size(); ++i) {
        frames[i].stamp_s = has_timestamps ? stamp_of(entries[i]) : frames[i].id / options.frames_per_second;
        if (i > 0 && !(frames[i].stamp_s > frames[i - 1].stamp_s)) {
            throw entries[i].error("timestamp " + format_number(frames[i].stamp_s) +
                                   " is not later than that of frame " + std::to_string(frames[i - 1].id));
        }
    }
}

// The size that most depth images have, by their headers; the first of those where several are as frequent. nullopt
// where none can be read.
std::optional<ImageSize> usual_size(const std::vector<Frame>& frames, const std::optional<ImageSize>& wanted) {
    std::vector<std::pair<ImageSize, int>> counts;
    for (const Frame& frame : frames) {
        ImageSize size;
        try {
            size = read_png_size(frame.depth);
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
                                 ": no depth image of the scene can be read, so the image size is not known");
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

Pose read_bop_pose(const JsonValue& frame, const std::string& rotation_key, const std::string& translation_key) {
    const JsonValue rotation = frame.at(rotation_key);
    const std::vector<double> r = rotation.numbers(9);
    const std::vector<double> t = frame.at(translation_key).numbers(3);
    Eigen::Matrix3d matrix;
    matrix << r[0], r[1], r[2], r[3], r[4], r[5], r[6], r[7], r[8];
    const double off = (matrix * matrix.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
    if (!(off < kRotationTolerance)) {
        throw rotation.error("is not a rotation: its rows are off unit length and right angles by " +
                             format_number(off));
    }
    if (matrix.determinant() < 0.0) throw rotation.error("is a reflection, not a rotation");
    return Pose::from_matrix(matrix, Eigen::Vector3d(t[0], t[1], t[2]) * 1e-3);
}

BopScene open_scene(const fs::path& folder, const SceneOptions& options) {
    check_options(options);
    if (!fs::is_directory(folder)) throw std::runtime_error(folder.string() + ": is not a folder");
    BopScene scene;
    scene.folder = folder;
    if (!fs::exists(folder / "scene_camera.json") && fs::is_directory(folder / "test")) {
        throw std::runtime_error(folder.string() + ": is a data set, not a scene; name one below " +
                                 (folder / "test").string());
    }
    const JsonFile file(folder / "scene_camera.json");
    std::vector<JsonValue> entries;
    for (const auto& [id, entry] : file.root().numbered_members()) {
        if (options.first_frame && id < *options.first_frame) continue;
        if (options.last_frame && id > *options.last_frame) continue;
        scene.frames.push_back(read_frame(folder, id, entry));
        entries.push_back(entry);
    }
    if (scene.frames.empty()) throw file.root().error("has no frame in the range that was asked for");
    for (const JsonValue& entry : entries) scene.has_timestamps |= entry.find("timestamp").has_value();
    set_stamps(scene.frames, entries, options, scene.has_timestamps);
    const ImageSize size = image_size(folder, scene.frames);
    for (Frame& frame : scene.frames) {
        frame.camera.width = size.width;
        frame.camera.height = size.height;
        validate(frame.camera);
    }
    scene.id = scene_number(folder, options);
    return scene;
}

DepthImage load_depth(const Frame& frame) {
    return read_depth_png(frame.depth, frame.depth_scale_mm, frame.camera.width, frame.camera.height);
}

std::optional<Pose> now_from_before(const Frame& now, const Frame& before) {
    if (!now.camera_from_world || !before.camera_from_world) return std::nullopt;
    return *now.camera_from_world * before.camera_from_world->inverse();
}

}  // namespace nearpose::data_set
