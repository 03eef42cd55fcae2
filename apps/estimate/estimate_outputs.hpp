// Everything an estimation writes: result file, log, trajectory, pictures.
#pragma once

#include <optional>

#include "apps/data_set/log_jsonl.hpp"
#include "apps/data_set/result_csv.hpp"
#include "apps/data_set/trajectory_tum.hpp"
#include "apps/estimate/frame_log.hpp"
#include "apps/runs/frame_source.hpp"
#include "apps/runs/run_options.hpp"
#include "core/estimator.hpp"
#include "raycast/embree_scene.hpp"

namespace nearpose::program {

// Throws BadUse where nothing is to be written, or two outputs have the same name.
void check(const OutputOptions& options);
// With the names that outputs without one get in the run folder, where there is one.
OutputOptions with_run_folder(OutputOptions options);

class EstimateOutputs {
  public:
    // Opens all files; `mesh` is what pictures show. Throws std::runtime_error naming the file.
    EstimateOutputs(const OutputOptions& options, const RunDescription& run, const Mesh& mesh);

    // Writes a frame's rows as soon as they are known. A frame without a pose has no row of poses.
    void append(const FrameInfo& frame, const FrameReport& report, const Observation& observation,
                const UpdateResult& result, const ParticleSet& particles);
    void close();

  private:
    void draw(const FrameReport& report, const Observation& observation, const UpdateResult& result) const;

    OutputOptions options_;
    int scene_id_, object_id_;
    data_set::PoseCsvWriter csv_;
    std::optional<data_set::JsonLinesWriter> log_, particles_;
    std::optional<data_set::TumWriter> trajectory_;
    std::optional<EmbreeScene> scene_;
};

}  // namespace nearpose::program
