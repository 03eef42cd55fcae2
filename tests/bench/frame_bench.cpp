// End to end: the frames of an approach after the first one, from depth image to pose, on 200 particles of 3 rounds.
#include <algorithm>

#include "tests/bench/described.hpp"
#include "tests/bench/naive/pipeline.hpp"
#include "tests/bench/tracking.hpp"

namespace nearpose::bench {
namespace {

constexpr int kParticles = 200;
constexpr int kTracked = kApproachFrames - 1;

// Error of the centre of the part's box [mm].
double error_mm(const Pose& found, const Frame& frame, const Eigen::Vector3d& centre) {
    return 1e3 * (found * centre - frame.camera_from_object * centre).norm();
}

// Every fourth frame, since they take long: it is the camera's distance that their cost follows.
void pipeline(benchmark::State& state) {
    constexpr int kEvery = 4;
    const Approach& approach = engine_block_approach();
    const Eigen::Vector3d centre = extent_of(engine_block()).centre_in_object();
    double last_error_mm = 0.0;
    int frames = 0;
    for (auto _ : state) {
        frames = 0;
        for (int k = kEvery; k <= kTracked; k += kEvery) {
            state.PauseTiming();
            const Frame& frame = approach.frames[static_cast<std::size_t>(k)];
            const Frame& before = approach.frames[static_cast<std::size_t>(k - 1)];
            naive::Pipeline naive(engine_block(), approach.camera, before.camera_from_object, kParticles);
            state.ResumeTiming();
            const Pose found = naive.update(frame.depth, frame.mask, approach.now_from_before(k));
            last_error_mm = error_mm(found, frame, centre);
            ++frames;
        }
    }
    describe(state, frames, "unit=frame");
    state.counters["last_error_mm"] = last_error_mm;
}

void ours(benchmark::State& state, Count count) {
    const int threads = static_cast<int>(state.range(0));
    const Approach& approach = engine_block_approach();
    const auto views = std::make_shared<EmbreeViewGenerator>(engine_block());
    const Eigen::Vector3d centre = views->extent().centre_in_object();
    std::vector<double> frame_ms;
    double last_error_mm = 0.0;
    for (auto _ : state) {
        state.PauseTiming();
        PoseEstimator estimator = make_estimator(views, kParticles, threads, count);
        track(estimator, approach, 0);
        state.ResumeTiming();
        for (int k = 1; k <= kTracked; ++k) {
            const double before_s = process_cpu_s();
            const UpdateResult result = track(estimator, approach, k);
            frame_ms.push_back(1e3 * (process_cpu_s() - before_s));
            last_error_mm = error_mm(result.camera_from_object, approach.frames[static_cast<std::size_t>(k)], centre);
        }
    }
    describe(state, kTracked, "unit=frame naive=frame/naive naive_least=40");
    std::nth_element(frame_ms.begin(), frame_ms.begin() + frame_ms.size() / 2, frame_ms.end());
    state.counters["median_frame_ms"] = frame_ms[frame_ms.size() / 2];
    state.counters["last_error_mm"] = last_error_mm;
}

BENCHMARK(pipeline)->Name("frame/naive")->Iterations(1)->MeasureProcessCPUTime()->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(ours, fixed, Count::kFixed)
    ->Name("frame/ours/threads")
    ->Arg(1)
    ->Arg(2)
    ->Iterations(1)
    ->MeasureProcessCPUTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(ours, adaptive, Count::kAdaptive)
    ->Name("frame/adaptive/threads")
    ->Arg(1)
    ->Iterations(1)
    ->MeasureProcessCPUTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace nearpose::bench
