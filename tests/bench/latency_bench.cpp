// When an answer is there: the first frame, frames while one mode holds, and frames under a time budget.
#include <algorithm>
#include <chrono>
#include <utility>
#include <vector>

#include "tests/bench/described.hpp"
#include "tests/bench/tracking.hpp"

namespace nearpose::bench {
namespace {

constexpr int kParticles = 200;

double median(std::vector<double>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

void first(benchmark::State& state, bool with_mask) {
    const Approach& approach = engine_block_approach();
    const Frame& frame = approach.frames.front();
    const auto views = std::make_shared<EmbreeViewGenerator>(engine_block());
    PoseEstimator estimator = make_estimator(views, kParticles, static_cast<int>(state.range(0)), Count::kAdaptive);
    std::vector<double> elapsed_ms;
    for (auto _ : state) {
        state.PauseTiming();
        estimator.reset();
        state.ResumeTiming();
        const auto mask = with_mask ? std::optional(frame.mask) : std::nullopt;
        const auto began = std::chrono::steady_clock::now();
        benchmark::DoNotOptimize(estimator.update(make_observation(frame.depth, approach.camera, mask), std::nullopt));
        elapsed_ms.push_back(
            std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - began).count());
    }
    describe(state, 1.0, "unit=frame");
    state.counters["median_elapsed_ms"] = median(elapsed_ms);
}

// The camera goes back and forth over the approach's nearer half, without ever jumping.
void held(benchmark::State& state) {
    const Approach& approach = engine_block_approach();
    PoseEstimator estimator =
        make_estimator(std::make_shared<EmbreeViewGenerator>(engine_block()), kParticles, 1, Count::kAdaptive);
    constexpr int kNear = kApproachFrames - 1, kFar = kApproachFrames / 2;
    for (int k = 0; k <= kNear; ++k) track(estimator, approach, k);
    std::vector<double> frame_ms;
    int at = kNear, step = -1, frames = 0;
    for (auto _ : state) {
        const int before = at;
        at += step;
        if (at == kFar || at == kNear) step = -step;
        const auto frame = [&](int k) -> const Frame& { return approach.frames[static_cast<std::size_t>(k)]; };
        DepthImage depth = frame(at).depth;  // the reader's own, which hands it over
        const double before_s = process_cpu_s();
        const UpdateResult result =
            estimator.update(make_observation(std::move(depth), approach.camera, frame(at).mask),
                             frame(at).camera_from_world * frame(before).camera_from_world.inverse());
        frame_ms.push_back(1e3 * (process_cpu_s() - before_s));
        frames += result.verdict == Verdict::kAccept;
    }
    describe(state, 1.0, "unit=frame");
    state.counters["median_frame_ms"] = median(frame_ms);
    state.counters["accepted_share"] = static_cast<double>(frames) / static_cast<double>(frame_ms.size());
}

// All frames of the approach, the search included; after it the budget is known to be kept or not.
void budget(benchmark::State& state) {
    const double budget_ms = static_cast<double>(state.range(0));
    const Approach& approach = engine_block_approach();
    const auto views = std::make_shared<EmbreeViewGenerator>(engine_block());
    std::vector<double> frame_ms;
    int reduced = 0;
    for (auto _ : state) {
        EstimatorOptions options;
        options.num_particles = kParticles;
        options.num_threads = 1;
        options.budget_s = 1e-3 * budget_ms;
        PoseEstimator estimator(views, std::make_shared<CeresPoseSolver>(), options);
        for (int k = 0; k < kApproachFrames; ++k) {
            const UpdateResult result = track(estimator, approach, k);
            if (k == 0) continue;  // the machine is learned in it
            frame_ms.push_back(1e3 * result.seconds.total);
            reduced += result.effort.reduced_for_budget;
        }
    }
    describe(state, kApproachFrames, "unit=frame");
    const auto count = static_cast<double>(frame_ms.size());
    const auto within = std::count_if(frame_ms.begin(), frame_ms.end(), [&](double ms) { return ms <= budget_ms; });
    state.counters["within_budget_share"] = static_cast<double>(within) / count;
    state.counters["reduced_share"] = reduced / count;
}

BENCHMARK_CAPTURE(first, mask, true)
    ->Name("first/mask/threads")
    ->Arg(1)
    ->Arg(2)
    ->MeasureProcessCPUTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(first, no_mask, false)
    ->Name("first/no_mask/threads")
    ->Arg(1)
    ->Arg(2)
    ->MeasureProcessCPUTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK(held)->Name("held/ours")->Iterations(200)->Unit(benchmark::kMillisecond);
BENCHMARK(budget)->Name("budget/ms")->Arg(5)->Arg(10)->Arg(20)->Arg(50)->Iterations(2)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace nearpose::bench
