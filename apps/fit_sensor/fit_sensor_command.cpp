#include "apps/fit_sensor/fit_sensor_command.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "apps/base/console.hpp"
#include "apps/base/number_text.hpp"
#include "apps/data_set/bop_scene.hpp"
#include "apps/depth_sensor/sensor_file.hpp"
#include "apps/fit_sensor/sensor_fit.hpp"

namespace nearpose::program {
namespace {

using data_set::format_fixed;
using simulate::FittedFigure;
using simulate::SensorFit;
using simulate::WallGroup;

struct FitSensorOptions {
    std::filesystem::path scene, out;
    std::string base = "close_stereo";
    std::string name;
    std::vector<int> region;  // U V W H [pixels]
    std::optional<int> first, last;
};

struct Recording {
    std::vector<simulate::WallFrame> frames;
    double depth_scale_mm = 0.0;  // the coarsest of the frames
    int unread = 0;
};

Recording read_recording(const FitSensorOptions& command) {
    data_set::SceneOptions options;
    options.scene_id = 0;  // of no concern: the folder may have any name
    options.first_frame = command.first;
    options.last_frame = command.last;
    Recording recording;
    for (const data_set::Frame& frame : data_set::open_scene(command.scene, options).frames) {
        recording.depth_scale_mm = std::max(recording.depth_scale_mm, frame.depth_scale_mm);
        try {
            recording.frames.push_back({frame.id, frame.camera, data_set::load_depth(frame)});
        } catch (const std::runtime_error& error) {
            print_error(error.what());
            ++recording.unread;
        }
    }
    if (recording.frames.empty()) {
        throw std::runtime_error(command.scene.string() + ": none of the " + std::to_string(recording.unread) +
                                 " frames has a depth image that could be read");
    }
    return recording;
}

std::optional<PixelBox> region_of(const FitSensorOptions& command, const PinholeCamera& camera) {
    if (command.region.empty()) return std::nullopt;
    const int u = command.region[0], v = command.region[1], width = command.region[2], height = command.region[3];
    if (u < 0 || v < 0 || width < 1 || height < 1 || u > camera.width - width || v > camera.height - height) {
        throw BadUse("--region U V W H must lie in the image of " + std::to_string(camera.width) + " x " +
                     std::to_string(camera.height) + " pixels");
    }
    return PixelBox{u, v, u + width, v + height};
}

std::string column(const std::string& text, std::size_t width) {
    return std::string(text.size() < width ? width - text.size() : 1, ' ') + text;
}

double degrees(double radians) {
    return radians * 180.0 / M_PI;
}

std::string span_text(double low, double high, int decimals) {
    return format_fixed(low, decimals) + "-" + format_fixed(high, decimals);
}

// One line a pose.
std::string table_of(const SensorFit& fit) {
    std::string text = column("frames", 6) + column("pixels", 9) + column("range_m", 9) + column("(from-to)", 15) +
                       column("angle_deg", 11) + column("(from-to)", 13) + column("sigma_mm", 10) +
                       column("fitted_mm", 11) + column("bias_mm", 9) + "\n";
    for (const WallGroup& group : fit.groups) {
        text +=
            column(std::to_string(group.frames), 6) + column(std::to_string(group.pixels), 9) +
            column(format_fixed(group.depth_m, 3), 9) + column(span_text(group.min_depth_m, group.max_depth_m, 3), 15) +
            column(format_fixed(degrees(group.angle_rad), 1), 11) +
            column(span_text(degrees(group.min_angle_rad), degrees(group.max_angle_rad), 1), 13) +
            column(format_fixed(1e3 * group.sigma_m, 3), 10) + column(format_fixed(1e3 * group.fitted_sigma_m, 3), 11) +
            column(fit.separated ? format_fixed(1e3 * group.bias_m, 3) : "-", 9) + "\n";
    }
    return text;
}

struct NamedFigure {
    const char* key;
    const char* unit;
    const FittedFigure& figure;
};

std::vector<NamedFigure> figures_of(const SensorFit& fit) {
    return {{"sigma_floor_m", "m", fit.sigma_floor_m},
            {"sigma_per_square_metre", "m/m^2", fit.sigma_per_square_metre},
            {"angle_factor", "", fit.angle_factor},
            {"correlation_pixels", "pixels", fit.correlation_pixels},
            {"bias_sigma_m", "m", fit.bias_sigma_m}};
}

// Four digits: more than any interval needs.
std::string short_number(double value) {
    if (value == 0.0 || !std::isfinite(value)) return "0";
    const int decimals = 3 - static_cast<int>(std::floor(std::log10(std::abs(value))));
    return format_fixed(value, std::clamp(decimals, 0, 12));
}

std::string interval_text(const FittedFigure& figure) {
    return "95 % " + short_number(figure.low) + " to " + short_number(figure.high);
}

std::string figures_text(const SensorFit& fit, const std::string& base) {
    std::string text;
    for (const NamedFigure& named : figures_of(fit)) {
        text += std::string(named.key) + " = " + short_number(named.figure.value);
        if (*named.unit != '\0') text += std::string(" ") + named.unit;
        if (named.figure.fitted) {
            text += "  (" + interval_text(named.figure) + ")\n";
        } else {
            text += &named.figure == &fit.bias_sigma_m ? "  (in the noise)\n" : "  (kept from " + base + ")\n";
        }
    }
    return text;
}

// Where the frames were taken from, in words.
std::string origin_of(const SensorFit& fit) {
    double near_m = 1e9, far_m = 0.0, steepest_rad = 0.0;
    for (const WallGroup& group : fit.groups) {
        near_m = std::min(near_m, group.min_depth_m);
        far_m = std::max(far_m, group.max_depth_m);
        steepest_rad = std::max(steepest_rad, group.max_angle_rad);
    }
    return "fitted from " + std::to_string(fit.frames) + " frames of a flat wall, " +
           std::to_string(fit.groups.size()) + (fit.groups.size() == 1 ? " pose, " : " poses, ") +
           span_text(near_m, far_m, 2) + " m, up to " + format_fixed(degrees(steepest_rad), 0) + " degrees";
}

simulate::SensorDescription description_of(const FitSensorOptions& command, const simulate::SensorDescription& base,
                                           const Recording& recording, const SensorFit& fit) {
    simulate::SensorDescription sensor = base;
    const std::string origin = origin_of(fit);
    sensor.name = command.name.empty() ? command.out.stem().string() : command.name;
    sensor.description = "Axial noise " + origin + "; all else as " + base.name + ".";
    sensor.noise = fit.noise;
    for (const NamedFigure& named : figures_of(fit)) {
        if (named.figure.fitted) {
            sensor.sources[std::string("noise.") + named.key] = origin + "; " + interval_text(named.figure);
        }
    }
    if (!fit.bias_sigma_m.fitted) {
        sensor.sources["noise.bias_sigma_m"] = origin + "; not told apart from noise, which holds it";
    }
    sensor.camera = recording.frames.front().camera;
    sensor.depth_scale_mm = recording.depth_scale_mm;
    sensor.sources["camera"] = sensor.sources["depth_scale_mm"] = "the recording that the noise was fitted to";
    return sensor;
}

int fit_sensor(const FitSensorOptions& command, const SharedOptions& shared) {
    const simulate::SensorDescription base = simulate::read_sensor(command.base);
    const Recording recording = read_recording(command);
    simulate::SensorFitOptions options;
    options.region = region_of(command, recording.frames.front().camera);
    const SensorFit fit = simulate::fit_sensor(recording.frames, base.noise, 1e-3 * recording.depth_scale_mm, options);
    simulate::write_sensor(command.out, description_of(command, base, recording, fit));
    print(table_of(fit) + "\n" + figures_text(fit, base.name));
    if (fit.misfit > 2.0) {
        print_notice("the sigmas depart from the fitted form by " + format_fixed(fit.misfit, 1) +
                         " times their errors; the intervals are widened by as much",
                     shared.quiet);
    }
    for (const std::string& note : fit.notes) print_notice(note, shared.quiet);
    if (recording.unread == 0) return kSuccess;
    print_error(std::to_string(recording.unread) + " frames could not be read");
    return kFramesUnread;
}

}  // namespace

void add_fit_sensor_command(CLI::App& app, const SharedOptions& shared, Run& run) {
    auto options = std::make_shared<FitSensorOptions>();
    CLI::App* command = app.add_subcommand("fit-sensor", "Sensor file from frames of a flat wall");
    command->add_option("--scene", options->scene, "BOP scene folder: scene_camera.json and depth/")->required();
    command->add_option("--region", options->region, "Pixels that show the wall: U V W H [the whole image]")
        ->expected(4);
    command->add_option("--first", options->first, "Number of the first frame [the scene's first]");
    command->add_option("--last", options->last, "Number of the last frame [the scene's last]");
    command->add_option("--base", options->base, "Sensor whose other figures are kept: built-in name or file");
    command->add_option("--out", options->out, "Sensor file to write")->required();
    command->add_option("--name", options->name, "The sensor's name [the file's]");
    command->footer(
        "Point the camera at a flat wall from several distances and angles, and hold it still for some frames each.");
    command->callback([options, &shared, &run] { run = [options, &shared] { return fit_sensor(*options, shared); }; });
}

}  // namespace nearpose::program
