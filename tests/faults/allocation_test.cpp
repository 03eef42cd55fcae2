// Memory runs out at any allocation of an update: the exception passes on, and the estimator is as it was.
//
// An update makes a thousand to sixty thousand allocations. Each of the first ones fails in its turn, then some at
// growing distances, and the last ones. Searches take longest and have fewer, unless NEARPOSE_LONG_TESTS is set.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <functional>
#include <new>
#include <optional>

#include "optim/ceres_pose_solver.hpp"
#include "raycast/embree_view_generator.hpp"
#include "tests/core/estimator_scene.hpp"
#include "tests/faults/belief_bits.hpp"
#include "tests/faults/failing_memory.hpp"

namespace nearpose {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)

constexpr int kFrame = 7;  // of the part's place; the frames before are 0 to 6

std::optional<Pose> motion(int frame) {
    return frame > 0 ? std::optional(motion_to(frame)) : std::nullopt;
}

// The part is gone; the mask lags behind and marks where it was, on the wall behind it.
Observation part_taken_away() {
    Mask mask;
    render(*kPart, truth_at(kFrame), kCamera, 0.9F, &mask);
    return make_observation({kCamera.width, kCamera.height, std::vector<float>(160 * 120, 0.9F)}, kCamera, mask);
}

// Which of `count` allocations fail: 1 to `each`, then at distances of a `share` of the number, then the last ones.
std::vector<long> numbers_up_to(long count, bool in_search) {
    const bool few = in_search && std::getenv("NEARPOSE_LONG_TESTS") == nullptr;
    const long each = few ? 8 : 300, last = few ? 3 : 20;
    const double share = few ? 0.8 : 0.02;
    std::vector<long> numbers;
    for (long n = 1; n <= count;) {
        numbers.push_back(n);
        const bool one_by_one = n < each || n + last >= count;
        n += one_by_one ? 1 : std::clamp(static_cast<long>(share * static_cast<double>(n)), 1L, count - last - n);
    }
    return numbers;
}

// The boxes of the part as one mesh.
Mesh mesh_of_part() {
    Mesh mesh;
    constexpr int kSides[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                   {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    for (const Box& box : asymmetric_part()) {
        const int first = static_cast<int>(mesh.vertices_in_object.size());
        for (int i = 0; i < 8; ++i)
            mesh.vertices_in_object.push_back(Eigen::Vector3d((i & 1 ? box.max : box.min).x(),
                                                              (i & 2 ? box.max : box.min).y(),
                                                              (i & 4 ? box.max : box.min).z())
                                                  .cast<float>());
        for (const auto& side : kSides) mesh.triangles.push_back({first + side[0], first + side[1], first + side[2]});
    }
    return mesh;
}

struct Moment {
    const char* name;
    int frames_before;
    std::function<Observation()> observe;
    const char* method = "default";
    bool own_ports = false;  // Embree and Ceres instead of the closed forms
};

void PrintTo(const Moment& moment, std::ostream* stream) {
    *stream << moment.name;
}

Observation seen() {
    return observe_at(kFrame);
}

PoseEstimator estimator_before(const Moment& moment, int threads) {
    const Method method = std::string(moment.method) == "paper" ? method_paper() : method_default();
    EstimatorOptions options = small_options(method, threads);
    options.method.search.candidates = std::min(options.method.search.candidates, 40);
    options.method.search.draws = 200;
    options.num_particles = 10;
    static const auto embree = std::make_shared<EmbreeViewGenerator>(mesh_of_part());
    static const auto ceres = std::make_shared<CeresPoseSolver>();
    PoseEstimator estimator =
        moment.own_ports ? PoseEstimator(embree, ceres, options) : PoseEstimator(kPart, kSolver, options);
    for (int k = 0; k < moment.frames_before; ++k) {
        const int frame = kFrame - moment.frames_before + k;
        estimator.update(observe_at(frame), k > 0 ? motion(frame) : std::nullopt);
    }
    return estimator;
}

class Allocation : public testing::TestWithParam<std::tuple<Moment, int, Shortage>> {};

TEST_P(Allocation, ThatFailsLeavesNoTrace) {
    const auto& [moment, threads, shortage] = GetParam();
    const PoseEstimator before = estimator_before(moment, threads);
    const std::vector<double> belief_before = bits_of(before.belief());
    const Observation observation = moment.observe(), gone = part_taken_away();
    const auto now_from_before = moment.frames_before > 0 ? motion(kFrame) : std::nullopt;

    PoseEstimator untroubled = before;
    long allocations = 0;
    std::vector<double> usual, usual_gone;
    {
        const MemoryFault none(0);
        usual = bits_of(untroubled.update(observation, now_from_before));
        allocations = none.allocations();
    }
    const std::vector<double> belief_after = bits_of(untroubled.belief());
    usual_gone = bits_of(PoseEstimator(before).update(gone, now_from_before));
    ASSERT_GT(allocations, 5);

    int failures = 0;
    for (const long n : numbers_up_to(allocations, moment.frames_before < 2)) {
        PoseEstimator estimator = before;
        std::optional<UpdateResult> result;
        {
            const MemoryFault fault(n, shortage);
            try {
                result = estimator.update(observation, now_from_before);
            } catch (const std::bad_alloc&) {
                ++failures;
            }
        }
        if (result) {  // one that can be done without, as the space of a sort: then nothing else changes
            ASSERT_EQ(bits_of(*result), usual) << "allocation " << n;
            ASSERT_EQ(bits_of(estimator.belief()), belief_after) << "allocation " << n;
            continue;
        }
        ASSERT_EQ(bits_of(estimator.belief()), belief_before) << "allocation " << n;
        PoseEstimator without_part = estimator;
        const UpdateResult nothing = without_part.update(gone, now_from_before);
        ASSERT_NE(nothing.verdict, Verdict::kAccept) << "allocation " << n;
        ASSERT_EQ(bits_of(nothing), usual_gone) << "allocation " << n;
        ASSERT_EQ(bits_of(estimator.update(observation, now_from_before)), usual) << "allocation " << n;
        ASSERT_EQ(bits_of(estimator.belief()), belief_after) << "allocation " << n;
    }
    RecordProperty("allocations", static_cast<int>(allocations));
    RecordProperty("failures", failures);
    EXPECT_GT(failures, 3);
}

const Moment kMoments[] = {
    {"first", 0, seen},
    {"first_without_mask", 0, [] { return observe_without_mask(kFrame); }},
    {"tracking", 7, seen},
    {"tracking_without_mask", 7, [] { return observe_without_mask(kFrame); }},
    {"repeated", 7, [] { return observe_at(kFrame - 1); }},
    {"nothing_seen", 7, observe_nothing},
    {"taken_away", 7, part_taken_away},
    {"paper", 1, seen, "paper"},
    {"first_with_own_ports", 0, seen, "default", true},
    {"tracking_with_own_ports", 7, seen, "default", true},
};

std::string name_of(const testing::TestParamInfo<std::tuple<Moment, int, Shortage>>& parameters) {
    const auto& [moment, threads, shortage] = parameters.param;
    return std::string(moment.name) + "_" + std::to_string(threads) + "_threads_" +
           (shortage == Shortage::kOnce ? "once" : "from_on");
}

INSTANTIATE_TEST_SUITE_P(OfAnUpdate, Allocation,
                         testing::Combine(testing::ValuesIn(kMoments), testing::Values(1, 2),
                                          testing::Values(Shortage::kOnce, Shortage::kFromOn)),
                         name_of);

// What changes the belief beside an update: all of it or nothing.
TEST(AllocationOfOthers, ThatFailsLeavesNoTraceOfRestoreAndReset) {
    const PoseEstimator tracking = estimator_before(kMoments[2], 1);
    PoseEstimator other = tracking;
    other.update(observe_at(kFrame), motion(kFrame));
    other.update(observe_without_mask(kFrame + 1), motion(kFrame + 1));
    const Belief kept = other.belief();
    const std::vector<std::function<void(PoseEstimator&)>> changes = {
        [&](PoseEstimator& estimator) { estimator.restore(kept); },
        [](PoseEstimator& estimator) { estimator.reset(); },
        [](PoseEstimator& estimator) {
            estimator.reset(truth_at(kFrame), {0.1, 0.01});
        },
    };
    for (std::size_t change = 0; change < changes.size(); ++change) {
        for (long n = 1; n < 100; ++n) {
            PoseEstimator estimator = tracking;
            bool failed = false;
            {
                const MemoryFault fault(n);
                try {
                    changes[change](estimator);
                } catch (const std::bad_alloc&) {
                    failed = true;
                }
            }
            if (!failed) break;
            ASSERT_EQ(bits_of(estimator.belief()), bits_of(tracking.belief())) << change << ", allocation " << n;
            EXPECT_LT(n, 99);
        }
    }
}

}  // namespace
}  // namespace nearpose
