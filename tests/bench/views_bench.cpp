// Views of all particles: ours, the bare Embree calls for the same rays, and single rays of 160 x 120 pixels.
#include <algorithm>

#include "tests/bench/described.hpp"
#include "tests/bench/fixture.hpp"
#include "tests/bench/naive/embree_rays.hpp"
#include "tests/bench/naive/single_ray_views.hpp"

namespace nearpose::bench {
namespace {

constexpr int kTotalRays = 6000;  // of an iteration: its packets must leave room for the tree in the cache

PinholeCamera grid_camera(int rays) {
    return camera_of(grid_of(still().observation, rays), still().camera);
}

std::vector<Pose> poses_for(int rays) {
    const std::vector<Pose>& particles = still().particles;
    const auto count = std::min<std::size_t>(particles.size(), kTotalRays / rays);
    return {particles.begin(), particles.begin() + static_cast<std::ptrdiff_t>(count)};
}

std::vector<naive::RayPacket> packets_for(int rays) {
    std::vector<naive::RayPacket> packets;
    for (const Pose& pose : poses_for(rays)) {
        const auto more = naive::prepare_packets(pose, grid_camera(rays));
        packets.insert(packets.end(), more.begin(), more.end());
    }
    return packets;
}

void cast_all(const naive::TriangleScene& scene, const std::vector<naive::RayPacket>& packets) {
    for (const naive::RayPacket& packet : packets) {
        alignas(64) RTCRayHit16 rays_and_hits = packet.rays;  // a cast shortens its rays
        scene.intersect(packet.valid, rays_and_hits);
        benchmark::DoNotOptimize(rays_and_hits);
    }
}

// The bare calls take turns with ours, so that what else the machine does falls on both: the counter bare_ratio.
void ours(benchmark::State& state) {
    constexpr int kTurn = 5;
    const int rays = static_cast<int>(state.range(0));
    const PinholeCamera camera = grid_camera(rays);
    const std::vector<Pose> poses = poses_for(rays);
    const naive::TriangleScene scene(engine_block());
    const std::vector<naive::RayPacket> packets = packets_for(rays);
    double ours_s = 0.0, bare_s = 0.0;
    for (auto _ : state) {
        state.PauseTiming();
        const double begin_s = process_cpu_s();
        for (int k = 0; k < kTurn; ++k) cast_all(scene, packets);
        const double middle_s = process_cpu_s();
        state.ResumeTiming();
        for (int k = 0; k < kTurn; ++k)
            for (const Pose& pose : poses) benchmark::DoNotOptimize(still().views.generate(pose, camera));
        bare_s += middle_s - begin_s;
        ours_s += process_cpu_s() - middle_s;
    }
    describe(state, kTurn * static_cast<double>(poses.size()),
             "unit=view naive=views/naive/160x120 bare=views/bare/" + std::to_string(rays) + " bare_most=1.5");
    state.counters["bare_ratio"] = ours_s / bare_s;
}

void bare(benchmark::State& state) {
    const int rays = static_cast<int>(state.range(0));
    const naive::TriangleScene scene(engine_block());
    const std::vector<naive::RayPacket> packets = packets_for(rays);
    for (auto _ : state) cast_all(scene, packets);
    describe(state, static_cast<double>(poses_for(rays).size()), "unit=view naive=views/naive/160x120");
}

void single_rays(benchmark::State& state) {
    const naive::SingleRayViews views(engine_block());
    const PinholeCamera camera = naive::quarter_camera(still().camera);
    constexpr int kPoses = 4;
    for (auto _ : state)
        for (int i = 0; i < kPoses; ++i)
            benchmark::DoNotOptimize(views.generate(still().particles[static_cast<std::size_t>(i)], camera));
    describe(state, kPoses, "unit=view");
}

BENCHMARK(single_rays)->Name("views/naive/160x120")->Unit(benchmark::kMillisecond);
BENCHMARK(bare)->Name("views/bare")->Arg(384)->Arg(768)->Arg(1500)->Arg(6000)->Unit(benchmark::kMillisecond);
BENCHMARK(ours)->Name("views/ours")->Arg(384)->Arg(768)->Arg(1500)->Arg(6000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace nearpose::bench
