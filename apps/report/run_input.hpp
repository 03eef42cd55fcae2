// Everything that the report of a run is made from, read and checked against each other.
#pragma once

#include <memory>
#include <optional>

#include "apps/error_measures/frame_errors.hpp"
#include "apps/report/run_log.hpp"
#include "apps/report/run_report.hpp"
#include "apps/runs/run_folder.hpp"
#include "raycast/mesh.hpp"

namespace nearpose::report {

struct RunInput {
    program::RunRecord record;  // its scene and models are where they are now
    std::unique_ptr<program::FrameSource> source;
    std::vector<std::size_t> frame_in_source;  // of each logged frame
    std::vector<LoggedFrame> log;
    std::map<int, std::vector<ParticleRow>> particles;
    std::map<int, Pose> truth;  // camera_from_object; empty where it is not known
    Mesh mesh;
    std::optional<data_set::ModelInfo> model_info;  // of models_info.json: symmetries
};

RunInput read_run(const std::filesystem::path& folder, const RunReportOptions& options,
                  const std::function<void(const std::string&)>& notice);

}  // namespace nearpose::report
