// The fit of the chosen mode: five rounds of plain registration on all seen points against ours, which fits the
// sensor's errors too and tells a covariance.
#include "core/fit/joint_fit.hpp"
#include "core/method.hpp"
#include "tests/bench/described.hpp"
#include "tests/bench/fixture.hpp"
#include "tests/bench/naive/pipeline.hpp"

namespace nearpose::bench {
namespace {

// A few millimetres off the truth.
const Pose& start() {
    return still().particles[1];
}

void registration(benchmark::State& state) {
    constexpr int kRounds = 5, kAll = 1 << 20;
    const naive::SingleRayViews views(engine_block());
    const naive::CloudIndex cloud(still().observation.points_in_camera());
    const PinholeCamera camera = naive::quarter_camera(still().camera);
    const naive::RegistrationOptions one_round{1, 0, kAll};
    for (auto _ : state) {
        Pose pose = start();
        for (int round = 0; round < kRounds; ++round) {
            const RandomStream unused(1, 1, 1, RandomPurpose::kSampleConsensus);
            pose = naive::register_pose(pose, views, camera, cloud, one_round, unused).camera_from_object;
        }
        benchmark::DoNotOptimize(pose);
    }
    describe(state, 1.0, "unit=fit");
}

// Calls `measured` with what the estimator gives its fine fit.
template <typename Measured>
void with_context(const Measured& measured) {
    const Method method = method_default();
    const ObservedGrid observed =
        observe(still().observation, grid_of(still().observation, method.refinement.max_rays));
    PixelCostOptions pixel_cost = method.pixel_cost;
    pixel_cost.extra_sigma_m = method.step.extra_sigma_diameters * still().views.extent().diameter_m();
    measured(StepContext{still().views, still().solver, still().observation, observed, method.step, method.cost,
                         pixel_cost, method.scale_by_overlap});
}

void ours(benchmark::State& state) {
    with_context([&](const StepContext& context) {
        for (auto _ : state) benchmark::DoNotOptimize(fit_jointly(start(), context));
    });
    describe(state, 1.0, "unit=fit naive=fine_fit/naive");
}

void covariance(benchmark::State& state) {
    with_context([&](const StepContext& context) {
        for (auto _ : state) benchmark::DoNotOptimize(covariance_at(start(), context));
    });
    describe(state, 1.0, "unit=covariance");
}

void refinement(benchmark::State& state) {
    with_context([&](const StepContext& context) {
        for (auto _ : state) benchmark::DoNotOptimize(refine_mode(start(), context, method_default().refinement));
    });
    describe(state, 1.0, "unit=mode naive=fine_fit/naive");
}

BENCHMARK(registration)->Name("fine_fit/naive")->Unit(benchmark::kMillisecond);
BENCHMARK(ours)->Name("fine_fit/ours")->Unit(benchmark::kMillisecond);
BENCHMARK(covariance)->Name("fine_fit/covariance")->Unit(benchmark::kMillisecond);
BENCHMARK(refinement)->Name("refinement/ours")->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace nearpose::bench
