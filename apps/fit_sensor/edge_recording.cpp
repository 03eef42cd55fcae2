#include "apps/fit_sensor/edge_recording.hpp"

#include <map>
#include <stdexcept>

#include "apps/base/console.hpp"
#include "apps/base/number_text.hpp"
#include "apps/data_set/bop_ground_truth.hpp"
#include "apps/data_set/bop_scene.hpp"
#include "apps/fit_sensor/column.hpp"
#include "raycast/depth_renderer.hpp"
#include "raycast/embree_scene.hpp"

namespace nearpose::program {
namespace {

using data_set::format_fixed;
using simulate::FittedFigure;

std::string figure_columns(const simulate::EdgeSide& side, const FittedFigure& figure, std::size_t width) {
    return column(side.edges > 0 ? format_fixed(figure.value, 2) : "-", width) +
           column(figure.fitted ? format_fixed(figure.low, 2) + " to " + format_fixed(figure.high, 2) : "-", 16);
}

std::string growth_line(const char* name, const FittedFigure& figure) {
    if (!figure.fitted) return std::string(name) + ": not determined\n";
    return std::string(name) + " = " + format_fixed(figure.value, 2) + " pixels  (95 % " + format_fixed(figure.low, 2) +
           " to " + format_fixed(figure.high, 2) + ")\n";
}

}  // namespace

MeasuredEdges measure_edges(const EdgeRecording& recording, const SharedOptions& shared) {
    const std::map<int, Pose> truth = data_set::read_ground_truth(recording.scene, recording.model.object);
    const EmbreeScene object(load_model(recording.model, shared));
    data_set::SceneOptions options;
    options.scene_id = 0;  // of no concern: the folder may have any name
    simulate::EdgeMeter meter;
    MeasuredEdges edges;
    const data_set::BopScene scene = data_set::open_scene(recording.scene, options);
    for (const data_set::Notice& notice : scene.notices.all()) print_notice(to_text(notice), shared.quiet);
    for (const data_set::Frame& frame : scene.frames) {
        const auto pose = truth.find(frame.id);
        if (pose == truth.end()) continue;
        try {
            meter.add(data_set::load_depth(frame), render_depth(object, pose->second, frame.camera));
            ++edges.frames;
        } catch (const std::exception& error) {
            print_error("frame " + std::to_string(frame.id) + ": " + error.what());
            ++edges.unread;
        }
    }
    if (edges.frames == 0)
        throw std::runtime_error(recording.scene.string() + ": none of the " + std::to_string(edges.unread) +
                                 " frames with the object could be read");
    edges.growth = meter.growth();
    return edges;
}

std::string edges_text(const MeasuredEdges& edges) {
    std::string text = "edges of the object in " + std::to_string(edges.frames) + " frames\n" + column("side", 6) +
                       column("edges", 9) + column("no_depth", 10) + column("places", 8) + column("growth_pixels", 15) +
                       column("(95 %)", 16) + column("scatter_pixels", 16) + column("(95 %)", 16) + "\n";
    for (std::size_t i = 0; i < edges.growth.sides.size(); ++i) {
        const simulate::EdgeSide& side = edges.growth.sides[i];
        text += column(simulate::kSideNames[i], 6) + column(std::to_string(side.edges), 9) +
                column(std::to_string(side.without_depth), 10) + column(std::to_string(side.places), 8) +
                figure_columns(side, side.growth_pixels, 15) + figure_columns(side, side.scatter_pixels, 16) + "\n";
    }
    return text + growth_line("edge_growth_rows_pixels", edges.growth.along_rows) +
           growth_line("edge_growth_columns_pixels", edges.growth.along_columns);
}

}  // namespace nearpose::program
