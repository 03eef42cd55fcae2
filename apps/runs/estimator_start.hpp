// The estimator of a run, made and started as its options say.
#pragma once

#include <memory>

#include "apps/base/command.hpp"
#include "apps/runs/estimator_setup.hpp"
#include "apps/runs/run_options.hpp"
#include "core/estimator.hpp"
#include "raycast/mesh.hpp"

namespace nearpose::program {

Tolerance tolerance_of(const EstimateOptions& options);

// Tells the user which symmetries are taken.
EstimatorSetup setup_of(const EstimateOptions& options, const Mesh& mesh, const SharedOptions& shared);

// At the initial pose, where the options give one. `views` are those of the setup.
PoseEstimator start_estimator(const EstimatorSetup& setup, std::shared_ptr<const ViewGenerator> views,
                              const EstimateOptions& options);

}  // namespace nearpose::program
