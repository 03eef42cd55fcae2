// Depth sensors as data: JSON files in apps/sensors, built into the program under their names.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "apps/depth_sensor/sensor_noise.hpp"
#include "apps/depth_sensor/stereo_rig.hpp"
#include "core/base/camera.hpp"

namespace nearpose::simulate {

struct SensorDescription {
    std::string name;
    std::string description;
    PinholeCamera camera;
    double depth_scale_mm = 1.0;  // millimetres per count
    SensorNoise noise;            // beside `stereo` what its depth is like; only the range is used there
    std::optional<StereoRig> stereo;
    // Where a figure comes from, by its key: "camera", "depth_scale_mm", "noise.sigma_floor_m" and so on.
    std::map<std::string, std::string> sources;
};

// The keys of the figures that a file with these sections has, of "noise", "active_stereo" and "structured_light", with
// those of its camera.
std::vector<std::string> sensor_figures(const std::vector<std::string>& sections);

// The names of those that are built in.
const std::vector<std::string>& sensor_names();

// One of these names, or else the path of a JSON file. Throws std::runtime_error naming file, key, value and bound, and
// for neither a name nor a file, listing the names.
SensorDescription read_sensor(const std::string& name_or_path);

// Throws std::invalid_argument for figures that read_sensor would refuse.
void write_sensor(const std::filesystem::path& path, const SensorDescription& sensor);

}  // namespace nearpose::simulate
