// A recording of an object before something farther, with its true poses: what fit-sensor measures edge growth from.
#pragma once

#include <filesystem>
#include <string>

#include "apps/base/command.hpp"
#include "apps/fit_sensor/edge_growth.hpp"
#include "apps/part_model/model_input.hpp"

namespace nearpose::program {

struct EdgeRecording {
    std::filesystem::path scene;  // BOP scene folder with scene_gt.json
    ModelOptions model;           // a folder of BOP models and the object's number
};

struct MeasuredEdges {
    simulate::EdgeGrowth growth;
    int frames = 0;
    int unread = 0;  // frames without a depth image that could be read; each is told on the console
};

// Renders the object at its true pose in every frame. Of several instances the first counts. Throws std::runtime_error
// naming the file where there is no truth, no model, or no frame that could be read.
MeasuredEdges measure_edges(const EdgeRecording& recording, const SharedOptions& shared);

// A table of the sides, and the growth along rows and columns, each line with its unit and interval.
std::string edges_text(const MeasuredEdges& edges);

}  // namespace nearpose::program
