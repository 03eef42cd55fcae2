// The estimator: the paper's particle filter over SE(3), one observation at a time.
#pragma once

#include <memory>
#include <optional>

#include "core/options.hpp"
#include "core/pose_solver.hpp"
#include "core/result.hpp"
#include "core/update/belief.hpp"
#include "core/update/frame.hpp"
#include "core/update/object_model.hpp"
#include "core/update/time_budget.hpp"
#include "core/view_generator.hpp"

namespace nearpose {

// One estimator belongs to one caller thread; several estimators may run at once. The same seed and observations give
// the same bits for any number of threads. A copy goes on by itself from where it was made.
class PoseEstimator {
  public:
    // The constructor does all slow set-up. Throws std::invalid_argument for options out of bounds.
    PoseEstimator(std::shared_ptr<const ViewGenerator> views, std::shared_ptr<const PoseSolver> solver,
                  const EstimatorOptions& options);

    // Takes in one observation. `now_from_before` is the camera's measured motion since the last update: it maps camera
    // coordinates of the frame before to those of this one. Nothing, or a transform that is not finite: not measured.
    // Never throws for data. Where a view generator or solver throws, or memory is short, the exception passes on, and
    // the estimator is as before the call.
    UpdateResult update(const Observation& observation, const std::optional<Pose>& now_from_before);

    // Starts over: without a pose, or around one with a spread (standard deviations about the model's centre). Throws
    // std::invalid_argument for a pose that is not valid.
    void reset();
    void reset(const Pose& camera_from_object, const Diffusion& spread);

    // What is carried from one observation to the next. Put back, it gives the same bits for the same observations;
    // only a time budget keeps what it has learned of the machine's speed.
    const Belief& belief() const { return belief_; }
    // Throws std::invalid_argument for a belief that no update leaves: particles without weights or without a tracked
    // pose.
    void restore(const Belief& belief);

    const ParticleSet& particles() const { return belief_.particles; }

  private:
    // For an image that is the one before: nothing new was observed.
    UpdateResult take_prediction(const ImageMemory& image, const Frame& frame);

    std::shared_ptr<const ObjectModel> model_;
    std::shared_ptr<const PoseSolver> solver_;
    EstimatorOptions options_;
    TimeBudget budget_;
    Belief belief_;
};

}  // namespace nearpose
