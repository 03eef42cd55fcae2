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
#include "apps/fit_sensor/column.hpp"
#include "apps/fit_sensor/edge_recording.hpp"
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
    EdgeRecording edges;
};

struct Recording {
    std::vector<simulate::WallFrame> frames;
    double depth_scale_mm = 0.0;  // the coarsest of the frames
    int unread = 0;
};

Recording read_recording(const FitSensorOptions& command, const SharedOptions& shared) {
    data_set::SceneOptions options;
    options.scene_id = 0;  // of no concern: the folder may have any name
    options.first_frame = command.first;
    options.last_frame = command.last;
    Recording recording;
    const data_set::BopScene scene = data_set::open_scene(command.scene, options);
    for (const data_set::Notice& notice : scene.notices.all()) print_notice(to_text(notice), shared.quiet);
    for (const data_set::Frame& frame : scene.frames) {
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
    for (const NamedFigure& named : {NamedFigure{"correlation_rows_pixels", "", fit.row_correlation_pixels},
                                     NamedFigure{"correlation_columns_pixels", "", fit.column_correlation_pixels}}) {
        if (!named.figure.fitted) continue;
        text += std::string(named.key) + " = " + short_number(named.figure.value) + " pixels  (" +
                interval_text(named.figure) + ")\n";
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

// A noise section has no figure for it.
std::string growth_sentence(const std::optional<MeasuredEdges>& edges) {
    std::string text;
    if (!edges) return text;
    const auto add = [&](const FittedFigure& growth, const char* direction) {
        if (!growth.fitted) return;
        text += " Edges grow by " + format_fixed(growth.value, 2) + " pixels along " + direction + " (" +
                interval_text(growth) + "), which is not simulated.";
    };
    add(edges->growth.along_rows, "rows");
    add(edges->growth.along_columns, "columns");
    return text;
}

simulate::SensorDescription description_of(const FitSensorOptions& command, const simulate::SensorDescription& base,
                                           const Recording& recording, const SensorFit& fit,
                                           const std::optional<MeasuredEdges>& edges) {
    simulate::SensorDescription sensor = base;
    const std::string origin = origin_of(fit);
    sensor.name = command.name.empty() ? command.out.stem().string() : command.name;
    sensor.description = "Axial noise " + origin + "; all else as " + base.name + "." + growth_sentence(edges);
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

// nullopt where no recording of edges was named.
std::optional<MeasuredEdges> edges_of(const FitSensorOptions& command, const SharedOptions& shared) {
    if (command.edges.scene.empty() != command.edges.model.models.empty())
        throw BadUse("--edges and --models belong together: edges grow beside those of a model at its true pose");
    if (command.edges.scene.empty()) return std::nullopt;
    return measure_edges(command.edges, shared);
}

int exit_code(int unread) {
    if (unread == 0) return kSuccess;
    print_error(std::to_string(unread) + " frames could not be read");
    return kFramesUnread;
}

int fit_sensor(const FitSensorOptions& command, const SharedOptions& shared) {
    const simulate::SensorDescription base = simulate::read_sensor(command.base);
    if (base.stereo)
        throw BadUse("--base " + base.name +
                     ": must be a sensor of simple noise, which alone is fitted; the window of " +
                     section_of(*base.stereo) + " is found by comparing edge growth with that of its simulation");
    const std::optional<MeasuredEdges> edges = edges_of(command, shared);
    const Recording recording = read_recording(command, shared);
    simulate::SensorFitOptions options;
    options.region = region_of(command, recording.frames.front().camera);
    const SensorFit fit = simulate::fit_sensor(recording.frames, base.noise, 1e-3 * recording.depth_scale_mm, options);
    simulate::write_sensor(command.out, description_of(command, base, recording, fit, edges));
    print(table_of(fit) + "\n" + figures_text(fit, base.name) + (edges ? "\n" + edges_text(*edges) : ""));
    if (fit.misfit > 2.0) {
        print_notice("the sigmas depart from the fitted form by " + format_fixed(fit.misfit, 1) +
                         " times their errors; the intervals are widened by as much",
                     shared.quiet);
    }
    for (const std::string& note : fit.notes) print_notice(note, shared.quiet);
    if (!edges)
        print_notice("edge growth could not be determined: a flat wall has no edges; see --edges", shared.quiet);
    for (const std::string& note : edges ? edges->growth.notes : std::vector<std::string>{})
        print_notice(note, shared.quiet);
    return exit_code(recording.unread + (edges ? edges->unread : 0));
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
    command->add_option("--edges", options->edges.scene,
                        "BOP scene folder with scene_gt.json: an object before something farther; measures by how much "
                        "its edges grow");
    add_bop_model_options(*command, options->edges.model);
    command->footer(
        "Point the camera at a flat wall from several distances and angles, and hold it still for some frames each.");
    command->callback([options, &shared, &run] { run = [options, &shared] { return fit_sensor(*options, shared); }; });
}

}  // namespace nearpose::program
