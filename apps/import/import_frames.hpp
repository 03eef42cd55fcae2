// Recordings of other tools into the BOP layout: <out> = <set>/test/<scene> with depth/000000.png ...,
// scene_camera.json (cam_K, depth_scale, timestamp), and <set>/camera.json. The 16-bit counts stay as they are; the
// scale goes to depth_scale.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace nearpose::data_set {

struct ImportSummary {
    std::filesystem::path scene;
    int frames = 0;
    double depth_scale_mm = 0.0;        // millimetres per count, as written
    std::vector<std::string> warnings;  // sentences for the user
};

// RealSense: the files *_Depth_<milliseconds>.raw of `rs-convert -d -r`: 16 bit little endian, no header. Ordered by
// their stamps, which are kept, in seconds.
struct RealSenseRawImport {
    std::filesystem::path raw_folder;
    std::filesystem::path camera_json;  // of the depth stream at the recorded size
    double depth_unit_m = 0.001;        // metres per count: librealsense's "Depth Units"
    std::filesystem::path out_scene;
};
ImportSummary import_realsense_raw(const RealSenseRawImport& options);

// Open3D: depth/00000.png ... and intrinsic.json, which has the matrix column-major and units per metre as depth_scale.
// The frames carry no stamps but keep their numbers, which make the stamps.
struct Open3dImport {
    std::filesystem::path folder;
    std::filesystem::path out_scene;
    double frames_per_second = 30.0;  // the stamps are frame number / frames per second
};
ImportSummary import_open3d(const Open3dImport& options);

// TUM RGB-D: depth.txt ("stamp depth/name.png") and 16-bit images of `units_per_metre` counts a metre.
struct TumImport {
    std::filesystem::path folder;
    std::filesystem::path camera_json;  // TUM's own downloads have no intrinsics
    double units_per_metre = 5000.0;
    std::filesystem::path out_scene;
};
ImportSummary import_tum(const TumImport& options);

}  // namespace nearpose::data_set
