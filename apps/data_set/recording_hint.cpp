#include "apps/data_set/recording_hint.hpp"

#include <map>
#include <system_error>

#include "apps/data_set/image_files.hpp"

namespace nearpose::data_set {
namespace {

constexpr const char* kRosBag =
    "the Python package rosbags reads it without ROS: save each depth image as depth/NNNNNN.npy as it stands, and "
    "write "
    "scene_camera.json beside the folder";

}  // namespace

std::string recording_hint(const std::filesystem::path& path) {
    static const std::map<std::string, std::string> kHints = {
        {".bag", "is a bag. Of a RealSense: rs-convert -d -r raw/part, then nearpose import --realsense-raw. Of ROS: " +
                     std::string(kRosBag)},
        {".mcap", "is a bag of ROS 2 (MCAP): " + std::string(kRosBag)},
        {".db3", "is a bag of ROS 2 (SQLite): " + std::string(kRosBag)},
        {".zdf",
         "is a Zivid frame: save it from Zivid Studio as PLY or PCD, in metres, and give the folder to --clouds"},
        {".svo", "is a ZED recording: save its depth with the ZED SDK as 16-bit PNG, as a scene's depth/NNNNNN.png"},
        {".svo2", "is a ZED recording: save its depth with the ZED SDK as 16-bit PNG, as a scene's depth/NNNNNN.png"},
        {".oni", "is an OpenNI recording: save its depth with OpenNI 2 as 16-bit PNG, as a scene's depth/NNNNNN.png"},
        {".mkv", "is a video. Of an Azure Kinect: save its depth track as 16-bit PNG, as a scene's depth/NNNNNN.png"},
        {".ply", "is a cloud: give its folder to --clouds, with --camera"},
        {".pcd", "is a cloud: give its folder to --clouds, with --camera"},
    };
    std::error_code ignored;
    if (std::filesystem::exists(path / "metadata.yaml", ignored)) return "is a bag of ROS 2: " + std::string(kRosBag);
    const auto found = kHints.find(lower_extension(path));
    return found == kHints.end() ? std::string() : found->second;
}

}  // namespace nearpose::data_set
