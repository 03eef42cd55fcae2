// The least squares step on the same pairs: one autodiff block a pair against our solver.
#include "core/filter/association.hpp"
#include "tests/bench/described.hpp"
#include "tests/bench/fixture.hpp"
#include "tests/bench/naive/least_squares.hpp"

namespace nearpose::bench {
namespace {

constexpr int kPoses = 20;
constexpr int kRays = 768;

std::vector<Correspondences> pairs_of_swarm() {
    const PinholeCamera camera = camera_of(grid_of(still().observation, kRays), still().camera);
    std::vector<Correspondences> pairs;
    for (int i = 0; i < kPoses; ++i) {
        const Pose& pose = still().particles[static_cast<std::size_t>(i)];
        pairs.push_back(
            associate_projective(still().views.generate(pose, camera), pose, still().observation, 0.04, 0.005));
    }
    return pairs;
}

std::vector<naive::Pair> plain(const Correspondences& pairs) {
    std::vector<naive::Pair> result;
    for (std::size_t k = 0; k < pairs.size(); ++k)
        result.push_back({pairs.points_in_object[k].cast<double>(), pairs.normals_in_object[k].cast<double>(),
                          pairs.points_in_camera[k].cast<double>(), static_cast<double>(pairs.sigmas_m[k])});
    return result;
}

void blocks(benchmark::State& state) {
    std::vector<std::vector<naive::Pair>> pairs;
    for (const Correspondences& of_pose : pairs_of_swarm()) pairs.push_back(plain(of_pose));
    for (auto _ : state)
        for (std::size_t i = 0; i < pairs.size(); ++i)
            benchmark::DoNotOptimize(naive::solve_point_to_plane(pairs[i], still().particles[i]));
    describe(state, kPoses, "unit=solve");
    state.counters["pairs"] = static_cast<double>(pairs.front().size());
}

void ours(benchmark::State& state) {
    const std::vector<Correspondences> pairs = pairs_of_swarm();
    for (auto _ : state)
        for (std::size_t i = 0; i < pairs.size(); ++i)
            benchmark::DoNotOptimize(still().solver.solve(pairs[i], still().particles[i]));
    describe(state, kPoses, "unit=solve naive=least_squares/naive");
    state.counters["pairs"] = static_cast<double>(pairs.front().size());
}

BENCHMARK(blocks)->Name("least_squares/naive")->Unit(benchmark::kMillisecond);
BENCHMARK(ours)->Name("least_squares/ours")->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace nearpose::bench
