#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>

#include "apps/base/file_io.hpp"
#include "apps/base/number_text.hpp"
#include "apps/base/text_split.hpp"
#include "apps/data_set/bop_scene.hpp"
#include "apps/data_set/bop_writer.hpp"
#include "apps/data_set/camera_json.hpp"
#include "apps/data_set/image_files.hpp"
#include "apps/data_set/png_file.hpp"
#include "apps/import/import_frames.hpp"

namespace nearpose::data_set {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMaxListBytes = 64u << 20;

struct SourceImage {
    fs::path file;
    int id = 0;
    double stamp_s = 0.0;
};

void require_folder(const fs::path& folder) {
    if (!fs::is_directory(folder)) throw std::runtime_error(folder.string() + ": is not a folder");
}

// Orders by stamp, of equal stamps by name, and numbers the frames from 0 on. What is said of equal ones; empty: none.
std::vector<std::string> order_by_stamp(std::vector<SourceImage>& images) {
    std::sort(images.begin(), images.end(), [](const auto& a, const auto& b) {
        return a.stamp_s != b.stamp_s ? a.stamp_s < b.stamp_s : a.file < b.file;
    });
    int repeated = 0;
    const SourceImage* first = nullptr;
    for (std::size_t i = 0; i < images.size(); ++i) {
        images[i].id = static_cast<int>(i);
        if (i == 0 || images[i].stamp_s > images[i - 1].stamp_s) continue;
        if (++repeated == 1) first = &images[i];
    }
    if (repeated == 0) return {};
    return {std::to_string(repeated) + (repeated == 1 ? " image has" : " images have") +
            " the stamp of the one before (the first: " + first->file.string() + "); were they written twice?"};
}

// The counts of one image, whatever the source's format.
using ReadCounts = CountImage (*)(const fs::path& file, const PinholeCamera& camera);

CountImage read_raw(const fs::path& file, const PinholeCamera& camera) {
    const std::uintmax_t expected =
        std::uintmax_t{2} * static_cast<unsigned>(camera.width) * static_cast<unsigned>(camera.height);
    if (!fs::is_regular_file(file)) throw std::runtime_error(file.string() + ": is not a regular file");
    const std::uintmax_t size = fs::file_size(file);
    if (size != expected) {
        throw std::runtime_error(file.string() + ": has " + std::to_string(size) + " bytes, but " +
                                 std::to_string(camera.width) + " x " + std::to_string(camera.height) +
                                 " pixels of 16 bits make " + std::to_string(expected) +
                                 "; is the camera file of the recorded size?");
    }
    const std::string bytes = read_whole_file(file, expected);
    CountImage image{camera.width, camera.height, std::vector<std::uint16_t>(bytes.size() / 2)};
    for (std::size_t i = 0; i < image.counts.size(); ++i) {
        const auto low = static_cast<unsigned char>(bytes[2 * i]);
        const auto high = static_cast<unsigned char>(bytes[2 * i + 1]);
        image.counts[i] = static_cast<std::uint16_t>(low | high << 8);
    }
    return image;
}

CountImage read_png(const fs::path& file, const PinholeCamera& camera) {
    return read_count_png(file, camera.width, camera.height);
}

ImportSummary write_scene(const fs::path& out_scene, const std::vector<SourceImage>& images,
                          const PinholeCamera& camera, double depth_scale_mm, ReadCounts read) {
    BopSceneWriter writer(out_scene);
    ImportSummary summary{out_scene, 0, depth_scale_mm, {}};
    bool any_depth = false;
    for (const SourceImage& image : images) {
        const CountImage counts = read(image.file, camera);
        any_depth |=
            std::any_of(counts.counts.begin(), counts.counts.end(), [](const auto count) { return count > 0; });
        write_count_png(depth_path(out_scene, image.id), counts);
        FrameRecord record;
        record.id = image.id;
        record.camera = camera;
        record.depth_scale_mm = depth_scale_mm;
        record.timestamp_s = image.stamp_s;
        writer.add_frame(record);
        ++summary.frames;
    }
    writer.finish();
    if (!any_depth) summary.warnings.push_back("no image has a single measured pixel");
    return summary;
}

ImportSummary with(const std::vector<std::string>& warnings, ImportSummary summary) {
    summary.warnings.insert(summary.warnings.begin(), warnings.begin(), warnings.end());
    return summary;
}

double checked_scale(double depth_scale_mm, const std::string& option, double value) {
    if (depth_scale_mm > 0.0 && std::isfinite(depth_scale_mm)) return depth_scale_mm;
    throw std::invalid_argument(option + " is " + format_number(value) + ", but must be positive and finite");
}

// The stamp in a name such as part_Depth_1592837.25.raw [s]; nullopt for other files.
std::optional<double> stamp_in_name(const std::string& name) {
    constexpr std::string_view kMark = "_Depth_";
    constexpr std::string_view kEnd = ".raw";
    const std::size_t mark = name.rfind(kMark);
    if (mark == name.npos || !name.ends_with(kEnd)) return std::nullopt;
    const std::size_t begin = mark + kMark.size();
    const std::optional<double> milliseconds =
        parse_number(std::string_view(name).substr(begin, name.size() - kEnd.size() - begin));
    if (!milliseconds || !std::isfinite(*milliseconds)) return std::nullopt;
    return *milliseconds * 1e-3;
}

struct Open3dIntrinsics {
    PinholeCamera camera;
    std::optional<double> units_per_metre;
};

Open3dIntrinsics read_open3d_intrinsics(const fs::path& path) {
    const JsonFile file(path);
    const JsonValue root = file.root();
    const JsonValue matrix = root.at("intrinsic_matrix");
    const std::vector<double> k = matrix.numbers(9);  // column-major: fx 0 0, 0 fy 0, cx cy 1
    if (k[2] != 0.0 || k[5] != 0.0 || k[8] != 1.0 || k[1] != 0.0 || k[3] != 0.0) {
        throw matrix.error("must be a column-major pinhole matrix: fx, 0, 0, 0, fy, 0, cx, cy, 1");
    }
    refuse_distortion(root);
    Open3dIntrinsics result;
    result.camera = {root.at("width").integer(), root.at("height").integer(), k[0], k[4], k[6], k[7]};
    if (const auto scale = root.find("depth_scale")) result.units_per_metre = scale->number();
    try {
        validate(result.camera);
    } catch (const std::invalid_argument& error) {
        throw root.error(error.what());
    }
    return result;
}

SourceImage tum_image(const fs::path& folder, std::string_view line, const std::string& place) {
    const std::vector<std::string_view> parts = words(line);
    const std::optional<double> stamp_s = parts.size() == 2 ? parse_number(parts[0]) : std::nullopt;
    if (!stamp_s || !std::isfinite(*stamp_s)) throw std::runtime_error(place + "must be a stamp and a file name");
    const fs::path name = fs::path(parts[1]).lexically_normal();
    if (name.is_absolute() || name.begin()->string() == "..") {
        throw std::runtime_error(place + name.string() + " lies outside the recording's folder");
    }
    return {folder / name, 0, *stamp_s};
}

}  // namespace

ImportSummary import_realsense_raw(const RealSenseRawImport& options) {
    const double scale_mm = checked_scale(options.depth_unit_m * 1e3, "depth unit", options.depth_unit_m);
    require_folder(options.raw_folder);
    const PinholeCamera camera = read_camera_json(options.camera_json).camera;
    std::vector<SourceImage> images;
    for (const fs::directory_entry& entry : fs::directory_iterator(options.raw_folder)) {
        const std::optional<double> stamp_s = stamp_in_name(entry.path().filename().string());
        if (stamp_s) images.push_back({entry.path(), 0, *stamp_s});
    }
    if (images.empty()) {
        throw std::runtime_error(options.raw_folder.string() +
                                 ": has no file named *_Depth_<milliseconds>.raw; export with rs-convert -d -r");
    }
    const std::vector<std::string> warnings = order_by_stamp(images);
    return with(warnings, write_scene(options.out_scene, images, camera, scale_mm, read_raw));
}

ImportSummary import_open3d(const Open3dImport& options) {
    if (!(options.frames_per_second > 0.0) || !std::isfinite(options.frames_per_second)) {
        throw std::invalid_argument("frames per second is " + format_number(options.frames_per_second) +
                                    ", but must be positive and finite");
    }
    require_folder(options.folder / "depth");
    const Open3dIntrinsics intrinsics = read_open3d_intrinsics(options.folder / "intrinsic.json");
    const double units_per_metre = intrinsics.units_per_metre.value_or(1000.0);
    const double scale_mm = checked_scale(1000.0 / units_per_metre, "intrinsic.json: depth_scale", units_per_metre);
    std::vector<SourceImage> images;
    for (const fs::directory_entry& entry : fs::directory_iterator(options.folder / "depth")) {
        const auto number = parse_integer(entry.path().stem().string());
        const bool fits = number && *number >= 0 && *number <= std::numeric_limits<int>::max();
        if (lower_extension(entry.path()) != ".png" || !fits) continue;
        const double stamp_s = static_cast<double>(*number) / options.frames_per_second;
        images.push_back({entry.path(), static_cast<int>(*number), stamp_s});
    }
    if (images.empty()) throw std::runtime_error((options.folder / "depth").string() + ": has no image 00000.png ...");
    std::sort(images.begin(), images.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
    ImportSummary summary = write_scene(options.out_scene, images, intrinsics.camera, scale_mm, read_png);
    summary.warnings.push_back(
        "Open3D's recorder aligns depth to the colour camera: such images are resampled and their intrinsics are the "
        "colour camera's; a recording of the depth stream alone is better");
    if (!intrinsics.units_per_metre) {
        summary.warnings.push_back("intrinsic.json has no depth_scale; 1000 units per metre are assumed");
    }
    return summary;
}

ImportSummary import_tum(const TumImport& options) {
    const double scale_mm = checked_scale(1000.0 / options.units_per_metre, "units per metre", options.units_per_metre);
    require_folder(options.folder);
    const PinholeCamera camera = read_camera_json(options.camera_json).camera;
    const fs::path list = options.folder / "depth.txt";
    const std::string text = read_whole_file(list, kMaxListBytes);
    std::vector<SourceImage> images;
    std::size_t number = 0;
    for (const std::string_view line : lines(text)) {
        ++number;
        if (line.empty() || line.front() == '#') continue;
        images.push_back(tum_image(options.folder, line, list.string() + ": line " + std::to_string(number) + ": "));
    }
    if (images.empty()) throw std::runtime_error(list.string() + ": lists no image");
    const std::vector<std::string> warnings = order_by_stamp(images);
    return with(warnings, write_scene(options.out_scene, images, camera, scale_mm, read_png));
}

}  // namespace nearpose::data_set
