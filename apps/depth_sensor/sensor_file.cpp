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
NEARPOSE_EMBEDDED(stereo_d405_json)
NEARPOSE_EMBEDDED(stereo_d415_json)
NEARPOSE_EMBEDDED(stereo_d435_json)
NEARPOSE_EMBEDDED(structured_carmine_json)

namespace nearpose::simulate {
namespace {

using data_set::format_number;
using data_set::json_string;
using data_set::JsonFile;
using data_set::JsonValue;

constexpr int kFormat = 1;
constexpr const char* kRadius = "edge_radius_pixels";  // the one whole number of the noise
constexpr const char* kNoise = "noise";
constexpr const char* kStereo = "active_stereo";
constexpr const char* kLight = "structured_light";

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

struct StereoFigure {
    const char* key;
    double StereoRig::*value;
};
constexpr std::array kStereoFigures{
    StereoFigure{"baseline_m", &StereoRig::baseline_m},
    StereoFigure{"projector_m", &StereoRig::projector_m},
    StereoFigure{"dot_sigma_tan", &StereoRig::dot_sigma_tan},
    StereoFigure{"projector_width_tan", &StereoRig::projector_width_tan},
    StereoFigure{"projector_height_tan", &StereoRig::projector_height_tan},
    StereoFigure{"ambient", &StereoRig::ambient},
    StereoFigure{"infrared_sigma_grey", &StereoRig::infrared_sigma_grey},
    StereoFigure{"blur_pixels", &StereoRig::blur_pixels},
    StereoFigure{"min_range_m", &StereoRig::min_range_m},
    StereoFigure{"max_range_m", &StereoRig::max_range_m},
};
struct StereoNumber {
    const char* key;
    int StereoRig::*value;
};
constexpr std::array kStereoNumbers{
    StereoNumber{"dots", &StereoRig::dots},
    StereoNumber{"rays_per_pixel", &StereoRig::rays_per_pixel},
    StereoNumber{"window_pixels", &StereoRig::window_pixels},
    StereoNumber{"penalty_step", &StereoRig::penalty_step},
    StereoNumber{"penalty_jump", &StereoRig::penalty_jump},
    StereoNumber{"uniqueness_percent", &StereoRig::uniqueness_percent},
    StereoNumber{"left_right_pixels", &StereoRig::left_right_pixels},
    StereoNumber{"speckle_pixels", &StereoRig::speckle_pixels},
    StereoNumber{"speckle_range_pixels", &StereoRig::speckle_range_pixels},
};
// The flag of the kind and the number of dots fill a double. A figure that is added to StereoRig must be added here.
static_assert(sizeof(StereoRig) == kStereoFigures.size() * sizeof(double) + kStereoNumbers.size() * sizeof(int) + 4);

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

// Structured light has its projector where the right camera would be.
bool is_figure_of(const StereoFigure& figure, const std::string& section) {
    return section == kStereo || figure.value != &StereoRig::projector_m;
}

std::vector<std::string> stereo_keys(const std::string& section) {
    std::vector<std::string> keys;
    for (const StereoFigure& figure : kStereoFigures)
        if (is_figure_of(figure, section)) keys.emplace_back(figure.key);
    for (const StereoNumber& number : kStereoNumbers) keys.emplace_back(number.key);
    return keys;
}

StereoRig read_stereo(const JsonValue& object, const std::string& section) {
    refuse_other_keys(object, stereo_keys(section));
    StereoRig rig;
    for (const StereoFigure& figure : kStereoFigures)
        if (is_figure_of(figure, section)) rig.*figure.value = object.at(figure.key).number();
    for (const StereoNumber& number : kStereoNumbers) rig.*number.value = object.at(number.key).integer();
    rig.structured_light = section == kLight;
    if (rig.structured_light) rig.projector_m = rig.baseline_m;
    return rig;
}

void validate(const SensorDescription& sensor) {
    validate(sensor.camera);
    simulate::validate(sensor.noise);
    if (sensor.stereo) simulate::validate(*sensor.stereo);
    check_option("depth_scale_mm", sensor.depth_scale_mm, 1e-4, 100.0);
}

SensorDescription read_description(const JsonFile& file) {
    const JsonValue root = file.root();
    refuse_other_keys(
        root, {"format", "name", "description", "camera", "depth_scale_mm", kNoise, kStereo, kLight, "sources"});
    const int format = root.at("format").integer();
    if (format != kFormat) {
        throw root.at("format").error("is " + std::to_string(format) + ", but must be " + std::to_string(kFormat));
    }
    SensorDescription sensor;
    sensor.name = root.at("name").text();
    sensor.description = root.at("description").text();
    sensor.camera = read_camera(root.at("camera"));
    sensor.depth_scale_mm = root.at("depth_scale_mm").number();
    if (root.find(kStereo) && root.find(kLight))
        throw root.error(std::string("has ") + kStereo + " and " + kLight + ", but must have one of them");
    const char* const section = root.find(kLight) ? kLight : kStereo;
    const auto stereo = root.find(section);
    if (stereo) sensor.stereo = read_stereo(*stereo, section);
    if (!stereo || root.find(kNoise)) sensor.noise = read_noise(root.at(kNoise));
    if (stereo && !root.find(kNoise)) {
        sensor.noise.min_range_m = sensor.stereo->min_range_m;
        sensor.noise.max_range_m = sensor.stereo->max_range_m;
    }
    if (stereo && (sensor.noise.min_range_m != sensor.stereo->min_range_m ||
                   sensor.noise.max_range_m != sensor.stereo->max_range_m))
        throw stereo->error("min_range_m and max_range_m must be those of noise");
    const JsonValue sources = root.at("sources");
    refuse_other_keys(sources, sensor_figures({kNoise, section}));
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
        {"kinect_v1", NEARPOSE_EMBEDDED_BYTES(kinect_v1_json)},
        {"stereo_d405", NEARPOSE_EMBEDDED_BYTES(stereo_d405_json)},
        {"stereo_d415", NEARPOSE_EMBEDDED_BYTES(stereo_d415_json)},
        {"stereo_d435", NEARPOSE_EMBEDDED_BYTES(stereo_d435_json)},
        {"structured_carmine", NEARPOSE_EMBEDDED_BYTES(structured_carmine_json)}};
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

std::vector<std::string> sensor_figures(const std::vector<std::string>& sections) {
    std::vector<std::string> keys{"camera", "depth_scale_mm"};
    for (const std::string& section : sections) {
        const std::vector<std::string> figures = section == kNoise ? noise_keys() : stereo_keys(section);
        for (const std::string& figure : figures) keys.push_back(section + "." + figure);
    }
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
    if (sensor.stereo)
        throw std::invalid_argument(sensor.name + ": a sensor with " + section_of(*sensor.stereo) +
                                    " cannot be written, only simple noise");
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
