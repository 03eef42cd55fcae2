// The first frame, without any prior: 1,500 starts on the paper's sphere with two rounds of plain registration each
// against our search.
#include "core/search/sampling.hpp"
#include "tests/bench/described.hpp"
#include "tests/bench/naive/pipeline.hpp"
#include "tests/bench/tracking.hpp"

namespace nearpose::bench {
namespace {

void sphere(benchmark::State& state) {
    constexpr int kStarts = 1500, kMeasured = 30;  // of the starts, which are matches
    const PinholeCamera& camera = engine_block_approach().camera;
    const Frame& first = engine_block_approach().frames.front();
    const naive::SingleRayViews views(engine_block());
    naive::RegistrationOptions two_rounds;
    two_rounds.rounds = 2;
    for (auto _ : state) {
        const Observation observation = make_observation(first.depth, camera, first.mask);
        const naive::CloudIndex cloud(observation.points_in_camera());
        const ParticleSet starts = sample_on_sphere(observation, extent_of(engine_block()), kMeasured, 1, 1);
        for (const Pose& pose : starts.poses) {
            const RandomStream random(1, 1, 1, RandomPurpose::kSampleConsensus);
            benchmark::DoNotOptimize(
                naive::register_pose(pose, views, naive::quarter_camera(camera), cloud, two_rounds, random));
        }
    }
    describe(state, static_cast<double>(kMeasured) / kStarts, "unit=first-frame");
}

void ours(benchmark::State& state) {
    const auto views = std::make_shared<EmbreeViewGenerator>(engine_block());
    PoseEstimator estimator = make_estimator(views, 200, 1);
    const Approach& approach = engine_block_approach();
    for (auto _ : state) {
        estimator.reset();
        benchmark::DoNotOptimize(track(estimator, approach, 0));
    }
    describe(state, 1.0, "unit=first-frame naive=start/naive");
}

BENCHMARK(sphere)->Name("start/naive")->Unit(benchmark::kMillisecond);
BENCHMARK(ours)->Name("start/ours")->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace nearpose::bench
