#include "apps/depth_sensor/sensor_file.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>

#include "apps/base/embedded_file.hpp"
#include "apps/base/file_io.hpp"
#include "apps/base/number_text.hpp"
#include "apps/data_set/json_file.hpp"
#include "core/base/check.hpp"

NEARPOSE_EMBEDDED(close_stereo_json)
NEARPOSE_EMBEDDED(d405_json)
NEARPOSE_EMBEDDED(d435_json)
NEARPOSE_EMBEDDED(f200_json)
NEARPOSE_EMBEDDED(ideal_json)
NEARPOSE_EMBEDDED(kinect_v1_json)

namespace nearpose::simulate {
namespace {

using data_set::format_number;
using data_set::json_string;
using data_set::JsonFile;
using data_set::JsonValue;

constexpr int kFormat = 1;
constexpr const char* kRadius = "edge_radius_pixels";  // the one whole number

struct Figure {
    const char* key;
    double SensorNoise::*value;
};
constexpr std::array kFigures{
    Figure{"sigma_floor_m", &SensorNoise::sigma_floor_m},
    Figure{"sigma_per_square_metre", &SensorNoise::sigma_per_square_metre},
    Figure{"sigma_least_at_m", &SensorNoise::sigma_least_at_m},
    Figure{"angle_factor", &SensorNoise::angle_factor},
    Figure{"correlation_pixels", &SensorNoise::correlation_pixels},
    Figure{"jitter_pixels", &SensorNoise::jitter_pixels},
    Figure{"bias_sigma_m", &SensorNoise::bias_sigma_m},
    Figure{"bias_length_pixels", &SensorNoise::bias_length_pixels},
    Figure{"frame_bias_sigma_m", &SensorNoise::frame_bias_sigma_m},
    Figure{"frame_bias_length_pixels", &SensorNoise::frame_bias_length_pixels},
    Figure{"depth_scale_error", &SensorNoise::depth_scale_error},
    Figure{"baseline_m", &SensorNoise::baseline_m},
    Figure{"disparity_step_pixels", &SensorNoise::disparity_step_pixels},
    Figure{"grazing_begin_rad", &SensorNoise::grazing_begin_rad},
    Figure{"grazing_end_rad", &SensorNoise::grazing_end_rad},
    Figure{"grazing_drop_probability", &SensorNoise::grazing_drop_probability},
    Figure{"grazing_patch_pixels", &SensorNoise::grazing_patch_pixels},
    Figure{"specular_angle_rad", &SensorNoise::specular_angle_rad},
    Figure{"specular_drop_probability", &SensorNoise::specular_drop_probability},
    Figure{"specular_patch_pixels", &SensorNoise::specular_patch_pixels},
    Figure{"light_offset_m", &SensorNoise::light_offset_m},
    Figure{"edge_jump_m", &SensorNoise::edge_jump_m},
    Figure{"edge_drop_probability", &SensorNoise::edge_drop_probability},
    Figure{"flying_probability", &SensorNoise::flying_probability},
    Figure{"min_range_m", &SensorNoise::min_range_m},
    Figure{"max_range_m", &SensorNoise::max_range_m},
};
// All doubles, and the radius padded to one: a figure that is added to SensorNoise must be added here.
static_assert(sizeof(SensorNoise) == (kFigures.size() + 1) * sizeof(double));

std::string listed(const std::vector<std::string>& words) {
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
    return text;
}

void refuse_other_keys(const JsonValue& object, const std::vector<std::string>& known) {
    for (const auto& [key, value] : object.members()) {
        if (std::find(known.begin(), known.end(), key) == known.end()) {
            throw value.error("unknown key; there are: " + listed(known));
        }
    }
}

std::vector<std::string> noise_keys() {
    std::vector<std::string> keys{kRadius};
    for (const Figure& figure : kFigures) keys.emplace_back(figure.key);
    return keys;
}

PinholeCamera read_camera(const JsonValue& object) {
    refuse_other_keys(object, {"width", "height", "fx", "fy", "cx", "cy"});
    return {object.at("width").integer(), object.at("height").integer(), object.at("fx").number(),
            object.at("fy").number(),     object.at("cx").number(),      object.at("cy").number()};
}

SensorNoise read_noise(const JsonValue& object) {
    refuse_other_keys(object, noise_keys());
    SensorNoise noise;
    for (const Figure& figure : kFigures) noise.*figure.value = object.at(figure.key).number();
    noise.edge_radius_pixels = object.at(kRadius).integer();
    return noise;
}

void validate(const SensorDescription& sensor) {
    validate(sensor.camera);
    simulate::validate(sensor.noise);
    check_option("depth_scale_mm", sensor.depth_scale_mm, 1e-4, 100.0);
}

SensorDescription read_description(const JsonFile& file) {
    const JsonValue root = file.root();
    refuse_other_keys(root, {"format", "name", "description", "camera", "depth_scale_mm", "noise", "sources"});
    const int format = root.at("format").integer();
    if (format != kFormat) {
        throw root.at("format").error("is " + std::to_string(format) + ", but must be " + std::to_string(kFormat));
    }
    SensorDescription sensor;
    sensor.name = root.at("name").text();
    sensor.description = root.at("description").text();
    sensor.camera = read_camera(root.at("camera"));
    sensor.depth_scale_mm = root.at("depth_scale_mm").number();
    sensor.noise = read_noise(root.at("noise"));
    const JsonValue sources = root.at("sources");
    refuse_other_keys(sources, sensor_figures());
    for (const auto& [key, value] : sources.members()) sensor.sources[key] = value.text();
    try {
        validate(sensor);
    } catch (const std::invalid_argument& error) {
        throw root.error(error.what());  // names key, value and bound
    }
    return sensor;
}

const std::map<std::string, std::string_view>& built_in() {
    static const std::map<std::string, std::string_view> files{
        {"close_stereo", NEARPOSE_EMBEDDED_BYTES(close_stereo_json)},
        {"d405", NEARPOSE_EMBEDDED_BYTES(d405_json)},
        {"d435", NEARPOSE_EMBEDDED_BYTES(d435_json)},
        {"f200", NEARPOSE_EMBEDDED_BYTES(f200_json)},
        {"ideal", NEARPOSE_EMBEDDED_BYTES(ideal_json)},
        {"kinect_v1", NEARPOSE_EMBEDDED_BYTES(kinect_v1_json)}};
    return files;
}

}  // namespace

const std::vector<std::string>& sensor_names() {
    static const std::vector<std::string> names = [] {
        std::vector<std::string> all;
        for (const auto& [name, bytes] : built_in()) all.push_back(name);
        return all;
    }();
    return names;
}

std::vector<std::string> sensor_figures() {
    std::vector<std::string> keys{"camera", "depth_scale_mm"};
    for (const std::string& key : noise_keys()) keys.push_back("noise." + key);
    return keys;
}

SensorDescription read_sensor(const std::string& name_or_path) {
    const auto found = built_in().find(name_or_path);
    if (found != built_in().end()) {
        return read_description(JsonFile::from_text(std::string(found->second), "built-in sensor " + name_or_path));
    }
    std::error_code ignored;
    if (!std::filesystem::exists(name_or_path, ignored)) {
        throw std::runtime_error(name_or_path +
                                 ": neither a sensor file nor a built-in sensor; there are: " + listed(sensor_names()));
    }
    return read_description(JsonFile(name_or_path));
}

void write_sensor(const std::filesystem::path& path, const SensorDescription& sensor) {
    validate(sensor);
    const PinholeCamera& camera = sensor.camera;
    std::string text = "{\n  \"format\": " + std::to_string(kFormat) + ",\n  \"name\": " + json_string(sensor.name) +
                       ",\n  \"description\": " + json_string(sensor.description) +
                       ",\n  \"camera\": {\"width\": " + std::to_string(camera.width) +
                       ", \"height\": " + std::to_string(camera.height) + ", \"fx\": " + format_number(camera.fx) +
                       ", \"fy\": " + format_number(camera.fy) + ", \"cx\": " + format_number(camera.cx) +
                       ", \"cy\": " + format_number(camera.cy) +
                       "},\n  \"depth_scale_mm\": " + format_number(sensor.depth_scale_mm) + ",\n  \"noise\": {\n";
    for (const Figure& figure : kFigures) {
        text += "    \"" + std::string(figure.key) + "\": " + format_number(sensor.noise.*figure.value) + ",\n";
    }
    text += "    \"" + std::string(kRadius) + "\": " + std::to_string(sensor.noise.edge_radius_pixels) +
            "\n  },\n  \"sources\": {";
    const char* separator = "\n";
    for (const auto& [key, source] : sensor.sources) {
        text += separator + ("    " + json_string(key)) + ": " + json_string(source);
        separator = ",\n";
    }
    data_set::write_file_atomically(path, text + "\n  }\n}\n");
}

}  // namespace nearpose::simulate
