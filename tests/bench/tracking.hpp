// The default estimator on a simulated approach.
#pragma once

#include <memory>

#include "core/estimator.hpp"
#include "tests/bench/fixture.hpp"

namespace nearpose::bench {

// Fixed: all particles, three rounds each, in every frame. Adaptive: fewer while one mode holds, as by default.
enum class Count { kFixed, kAdaptive };

inline PoseEstimator make_estimator(std::shared_ptr<const ViewGenerator> views, int num_particles, int num_threads,
                                    Count count = Count::kFixed) {
    EstimatorOptions options;
    options.num_particles = num_particles;
    if (count == Count::kFixed) {
        options.method.effort.min_particles = num_particles;
        options.method.effort.predicted_rounds = options.method.step.rounds;
    }
    options.num_threads = num_threads;
    return PoseEstimator(std::move(views), std::make_shared<CeresPoseSolver>(), options);
}

// Reading the image counts: the observation is prepared here.
inline UpdateResult track(PoseEstimator& estimator, const Approach& approach, int k) {
    const Frame& frame = approach.frames[static_cast<std::size_t>(k)];
    std::optional<Pose> now_from_before;
    if (k > 0) now_from_before = approach.now_from_before(k);
    return estimator.update(make_observation(frame.depth, approach.camera, frame.mask), now_from_before);
}

}  // namespace nearpose::bench
