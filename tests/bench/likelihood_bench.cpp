// How well a pose explains the image, the view given: the cost of the nearest neighbours against the cost per pixel.
#include "core/evidence/likelihood.hpp"
#include "tests/bench/described.hpp"
#include "tests/bench/fixture.hpp"
#include "tests/bench/naive/pipeline.hpp"

namespace nearpose::bench {
namespace {

constexpr int kPoses = 20;
constexpr int kRays = 768;

PixelGrid grid() {
    return grid_of(still().observation, kRays);
}

std::vector<View> views_of_swarm() {
    const PinholeCamera camera = camera_of(grid(), still().camera);
    std::vector<View> views;
    for (int i = 0; i < kPoses; ++i)
        views.push_back(still().views.generate(still().particles[static_cast<std::size_t>(i)], camera));
    return views;
}

void nearest(benchmark::State& state) {
    constexpr double kGate_m = 0.03;
    const naive::CloudIndex cloud(still().observation.points_in_camera());
    const std::vector<View> views = views_of_swarm();
    for (auto _ : state) {
        for (std::size_t i = 0; i < views.size(); ++i) {
            const Pose& pose = still().particles[i];
            const auto pairs =
                naive::nearest_pairs({views[i].points_in_object, views[i].normals_in_object}, pose, cloud, kGate_m);
            benchmark::DoNotOptimize(naive::overlap_scaled_error(pairs, views[i].size(), pose, kGate_m));
        }
    }
    describe(state, kPoses, "unit=pose");
}

void pixels(benchmark::State& state, bool with_outline) {
    const std::vector<View> views = views_of_swarm();
    const ObservedGrid observed = observe(still().observation, grid());
    PixelCostOptions options;
    options.extra_sigma_m = 0.005;
    options.with_outline = with_outline;
    for (auto _ : state)
        for (std::size_t i = 0; i < views.size(); ++i)
            benchmark::DoNotOptimize(pixel_cost(views[i], still().particles[i], observed, options));
    describe(state, kPoses, "unit=pose naive=likelihood/naive");
}

BENCHMARK(nearest)->Name("likelihood/naive")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(pixels, plain, false)->Name("likelihood/ours")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(pixels, outline, true)->Name("likelihood/ours/outline")->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace nearpose::bench
