// Pairs for the views of all particles: one FLANN call a point against our batched index and our projective
// association.
#include "core/filter/association.hpp"
#include "tests/bench/described.hpp"
#include "tests/bench/fixture.hpp"
#include "tests/bench/naive/pipeline.hpp"

namespace nearpose::bench {
namespace {

constexpr int kPoses = 20;
constexpr int kRays = 768;
constexpr double kGate_m = 0.03;

std::vector<View> views_of_swarm() {
    const PinholeCamera camera = camera_of(grid_of(still().observation, kRays), still().camera);
    std::vector<View> views;
    for (int i = 0; i < kPoses; ++i)
        views.push_back(still().views.generate(still().particles[static_cast<std::size_t>(i)], camera));
    return views;
}

template <typename Associate>
void measure(benchmark::State& state, const std::string& label, const Associate& associate) {
    const std::vector<View> views = views_of_swarm();
    std::size_t points = 0;
    for (auto _ : state) {
        points = 0;
        for (std::size_t i = 0; i < views.size(); ++i) {
            benchmark::DoNotOptimize(associate(views[i], still().particles[i]));
            points += views[i].size();
        }
    }
    describe(state, 1e-3 * static_cast<double>(points), "unit=1000-points " + label);
}

void flann_per_query(benchmark::State& state) {
    const naive::CloudIndex cloud(still().observation.points_in_camera());  // the same cloud for all
    measure(state, "", [&](const View& view, const Pose& pose) {
        return naive::nearest_pairs({view.points_in_object, view.normals_in_object}, pose, cloud, kGate_m);
    });
}

void batched(benchmark::State& state) {
    measure(state, "naive=neighbours/naive", [](const View& view, const Pose& pose) {
        return associate_nearest(view, pose, still().observation, kGate_m);
    });
}

void projective(benchmark::State& state) {
    measure(state, "naive=neighbours/naive", [](const View& view, const Pose& pose) {
        return associate_projective(view, pose, still().observation, kGate_m, 0.005);
    });
}

void consensus(benchmark::State& state, bool ours) {
    const View view = views_of_swarm().front();
    const Correspondences pairs = associate_nearest(view, still().particles.front(), still().observation, kGate_m);
    std::vector<naive::Pair> plain;
    for (std::size_t k = 0; k < pairs.size(); ++k)
        plain.push_back({pairs.points_in_object[k].cast<double>(), pairs.normals_in_object[k].cast<double>(),
                         pairs.points_in_camera[k].cast<double>()});
    const RandomStream random(1, 1, 1, RandomPurpose::kSampleConsensus);
    constexpr int kHypotheses = 200;
    for (auto _ : state) {
        if (ours)
            benchmark::DoNotOptimize(reject_by_sample_consensus(pairs, {kHypotheses, 0.01}, random));
        else
            benchmark::DoNotOptimize(naive::sample_consensus(plain, kHypotheses, 0.01, random));
    }
    describe(state, 1.0, ours ? "unit=200-hypotheses naive=consensus/naive" : "unit=200-hypotheses");
}

BENCHMARK(flann_per_query)->Name("neighbours/naive")->Unit(benchmark::kMillisecond);
BENCHMARK(batched)->Name("neighbours/ours/batched")->Unit(benchmark::kMillisecond);
BENCHMARK(projective)->Name("neighbours/ours/projective")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(consensus, naive, false)->Name("consensus/naive")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(consensus, ours, true)->Name("consensus/ours")->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace nearpose::bench
