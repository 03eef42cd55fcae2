// One reader of the files of recordings: no bytes may crash it, make it hang or take gigabytes.
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string_view>

#include "apps/data_set/bop_ground_truth.hpp"
#include "apps/data_set/bop_models.hpp"
#include "apps/data_set/bop_scene.hpp"
#include "apps/data_set/camera_json.hpp"
#include "apps/data_set/png_file.hpp"
#include "apps/data_set/point_cloud_file.hpp"
#include "apps/data_set/pose_file.hpp"
#include "apps/data_set/result_csv.hpp"
#include "apps/data_set/trajectory_tum.hpp"

namespace nearpose {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kFormat = NEARPOSE_FUZZED;

// Of this process alone; in memory where there is such a file system.
fs::path make_folder() {
    const fs::path base = fs::is_directory("/dev/shm") ? fs::path("/dev/shm") : fs::temp_directory_path();
    const fs::path folder = base / ("nearpose_fuzz_" + std::string(kFormat) + "_" + std::to_string(::getpid()));
    fs::create_directories(folder / "test/000001");
    return folder;
}

struct Folder {
    ~Folder() { fs::remove_all(path); }
    fs::path path = make_folder();
};

void write(const fs::path& file, std::string_view bytes) {
    std::ofstream stream(file, std::ios::binary);
    stream << bytes;
}

void read_scene(const fs::path& folder, std::string_view bytes) {
    const fs::path scene = folder / "test/000001";
    write(folder / "camera.json", R"({"width":16,"height":12,"fx":20,"fy":20,"cx":8,"cy":6,"depth_scale":1.0})");
    // One file for all: what is no motion of a camera may be a true pose.
    write(scene / "scene_camera.json", bytes);
    write(scene / "scene_gt.json", bytes);
    try {
        data_set::open_scene(scene);
    } catch (const std::runtime_error&) {
        data_set::read_ground_truth(scene, 1);
    }
}

void read(const fs::path& folder, std::string_view bytes) {
    if (kFormat == "scene") return read_scene(folder, bytes);
    const fs::path file = folder / (kFormat == "pcd" ? "file.pcd" : kFormat == "ply_cloud" ? "file.ply" : "file");
    write(file, bytes);
    if (kFormat == "png") data_set::read_count_png(file);
    if (kFormat == "pcd" || kFormat == "ply_cloud") data_set::read_cloud(file);
    if (kFormat == "camera_json") data_set::read_camera_json(file);
    if (kFormat == "models_info") data_set::read_models_info(file);
    if (kFormat == "pose_json") program::read_pose_file(file);
    if (kFormat == "csv") data_set::read_pose_csv(file);
    if (kFormat == "tum") data_set::read_tum(file);
}

}  // namespace
}  // namespace nearpose

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const nearpose::Folder folder;
    try {
        nearpose::read(folder.path, {reinterpret_cast<const char*>(data), size});
    } catch (const std::runtime_error&) {
        // Refused, with a cause.
    } catch (const std::invalid_argument&) {
    }
    return 0;
}
