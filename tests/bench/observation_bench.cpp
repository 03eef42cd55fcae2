// From a depth image of 640 x 480 with a mask to what the particles read. Naively: the masked points, thinned to 2,000,
// an index over them and normals from 10 neighbours each; ours adds states, noise and a cloud of 3,000.
#include "tests/bench/described.hpp"
#include "tests/bench/fixture.hpp"
#include "tests/bench/naive/pipeline.hpp"

namespace nearpose::bench {
namespace {

void cloud(benchmark::State& state) {
    const Still& scene = still();
    for (auto _ : state) {
        const auto points = naive::back_project(scene.frame.depth, scene.frame.mask, scene.camera);
        const naive::CloudIndex index(naive::thinned(points, naive::kMaxCloudPoints));
        benchmark::DoNotOptimize(naive::estimate_normals(index));
    }
    describe(state, 1.0, "unit=image");
}

void ours(benchmark::State& state) {
    const Still& scene = still();
    for (auto _ : state) benchmark::DoNotOptimize(make_observation(scene.frame.depth, scene.camera, scene.frame.mask));
    describe(state, 1.0, "unit=image naive=observation/naive");
}

void grid(benchmark::State& state) {
    const PixelGrid rays = grid_of(still().observation, static_cast<int>(state.range(0)));
    for (auto _ : state) benchmark::DoNotOptimize(observe(still().observation, rays));
    describe(state, 1.0, "unit=grid");
}

BENCHMARK(cloud)->Name("observation/naive")->Unit(benchmark::kMillisecond);
BENCHMARK(ours)->Name("observation/ours")->Unit(benchmark::kMillisecond);
BENCHMARK(grid)->Name("observation/grid")->Arg(768)->Arg(6000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace nearpose::bench
