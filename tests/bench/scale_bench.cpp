// What a tracked frame costs by the number of particles, of triangles and of observed points; and the memory that it
// takes, which holds for the process: run.sh runs each size of mesh in one of its own.
#include <cmath>
#include <fstream>
#include <string>

#include "tests/bench/described.hpp"
#include "tests/bench/tessellation.hpp"
#include "tests/bench/tracking.hpp"

namespace nearpose::bench {
namespace {

constexpr int kParticles = 200;
constexpr int kFrames = 4;  // of the approach; the first is where the particles are put

double peak_memory_mb() {
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);)
        if (line.rfind("VmHWM:", 0) == 0) return std::stod(line.substr(6)) / 1024.0;
    return 0.0;
}

// Frames 1.. on, the particles spread around the true pose of frame 0.
void measure(benchmark::State& state, const Approach& approach, std::shared_ptr<const ViewGenerator> views,
             int num_particles) {
    const ModelExtent extent = views->extent();
    PoseEstimator estimator = make_estimator(std::move(views), num_particles, 1);
    const int last = static_cast<int>(approach.frames.size()) - 1;
    double points = 0.0;
    for (auto _ : state) {
        state.PauseTiming();
        estimator.reset(approach.frames.front().camera_from_object, {0.03, 0.008 * extent.diameter_m()});
        points = 0.0;
        state.ResumeTiming();
        for (int k = 1; k <= last; ++k) points += track(estimator, approach, k).points_observed;
    }
    state.counters["units"] = last;
    state.counters["points"] = points / last;
    state.counters["peak_mb"] = peak_memory_mb();
}

void by_particles(benchmark::State& state) {
    measure(state, make_approach(engine_block(), kFrames), std::make_shared<EmbreeViewGenerator>(engine_block()),
            static_cast<int>(state.range(0)));
    state.counters["x"] = static_cast<double>(state.range(0));
    state.SetLabel("unit=frame exponent_most=1.1");
}

// Sizes of the mesh by name, in triangles of about so many thousands.
void by_triangles(benchmark::State& state) {
    constexpr std::size_t kCoarse = 2000;
    const auto thousands = state.range(0);
    Approach approach;
    std::shared_ptr<const ViewGenerator> views;
    double triangles = 0.0;
    {
        Mesh mesh = thousands < 11 ? coarsen(engine_block(), kCoarse) : Mesh(engine_block());
        approach = make_approach(mesh, kFrames);  // a finer mesh is the same surface
        const int side = static_cast<int>(std::lround(std::sqrt(static_cast<double>(thousands) / 11.818)));
        if (side > 1) mesh = tessellate(mesh, side);
        triangles = static_cast<double>(mesh.triangles.size());
        views = std::make_shared<EmbreeViewGenerator>(mesh);
    }
    measure(state, approach, std::move(views), kParticles);
    state.counters["x"] = triangles;
    state.SetLabel("unit=frame exponent_most=0.9 memory_most=300");
}

void by_points(benchmark::State& state) {
    const double scale = static_cast<double>(state.range(0)) / 640.0;
    measure(state, make_approach(engine_block(), kFrames, scale), std::make_shared<EmbreeViewGenerator>(engine_block()),
            kParticles);
    state.counters["x"] = state.counters["points"];
    state.SetLabel("unit=frame exponent_most=0.9");
}

BENCHMARK(by_particles)
    ->Name("scale/particles")
    ->Arg(50)
    ->Arg(200)
    ->Arg(1000)
    ->Arg(10000)
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond);
BENCHMARK(by_triangles)
    ->Name("scale/thousand_triangles")
    ->Arg(2)
    ->Arg(12)
    ->Arg(106)
    ->Arg(957)
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond);
BENCHMARK(by_points)
    ->Name("scale/image_width")
    ->Arg(160)
    ->Arg(320)
    ->Arg(640)
    ->Arg(1280)
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace nearpose::bench
