// The belief is a value: it is kept, put back, copied, and untouched by an update that fails.
#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <stdexcept>
#include <vector>

#include "core/estimator.hpp"
#include "tests/core/estimator_scene.hpp"

namespace nearpose {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)

// A view generator of whose calls one throws, as a user's own might.
class FailingOnce : public ViewGenerator {
  public:
    View generate(const Pose& camera_from_object, const PinholeCamera& camera) const override {
        if (--calls_left == 0) throw std::runtime_error("the view generator failed");
        return kPart->generate(camera_from_object, camera);
    }
    const ModelExtent& extent() const override { return kPart->extent(); }

    mutable int calls_left = 0;  // until the one that throws; 0 or less: none does
};

std::optional<Pose> motion(int frame) {
    return frame > 0 ? std::optional(motion_to(frame)) : std::nullopt;
}

std::vector<double> numbers_of(const UpdateResult& result) {
    const Pose& pose = result.camera_from_object;
    std::vector<double> numbers(pose.rotation.coeffs().data(), pose.rotation.coeffs().data() + 4);
    numbers.insert(numbers.end(), pose.translation.data(), pose.translation.data() + 3);
    numbers.insert(numbers.end(), result.covariance.data(), result.covariance.data() + 36);
    numbers.push_back(result.effective_sample_size);
    numbers.push_back(result.pixels.agreement());
    return numbers;
}

EstimatorOptions one_thread() {
    return small_options(method_default(), 1);
}

// The part is taken away; the mask lags behind and marks where it was, on the wall behind it.
Observation part_taken_away(int frame) {
    Mask mask;
    render(*kPart, truth_at(frame), kCamera, 0.9F, &mask);
    return make_observation({kCamera.width, kCamera.height, std::vector<float>(160 * 120, 0.9F)}, kCamera, mask);
}

TEST(Belief, AnUpdateThatThrowsLeavesNoTrace) {
    // Wherever the view generator fails, the next frame is judged by itself: what was measured of the frame that failed
    // must not vouch for a part that is gone.
    int failures = 0;
    for (const int call : {1, 3, 9, 12, 15, 20, 25, 30}) {
        const auto views = std::make_shared<FailingOnce>();
        PoseEstimator estimator(views, kSolver, one_thread());
        for (int frame = 0; frame < 7; ++frame) estimator.update(observe_at(frame), motion(frame));
        PoseEstimator untroubled = estimator;
        views->calls_left = call;
        bool failed = false;
        try {
            estimator.update(observe_at(7), motion(7));
        } catch (const std::runtime_error&) {
            failed = true;
        }
        views->calls_left = 0;
        if (!failed) continue;  // the frame took fewer views
        ++failures;
        EXPECT_EQ(estimator.belief().step, untroubled.belief().step);
        const UpdateResult gone = estimator.update(part_taken_away(7), motion(7));
        EXPECT_EQ(gone.verdict, Verdict::kLost) << call;
        EXPECT_LT(gone.pixels.agreement(), 0.1) << call;
        EXPECT_EQ(numbers_of(gone), numbers_of(untroubled.update(part_taken_away(7), motion(7)))) << call;
    }
    EXPECT_GE(failures, 4);
}

TEST(Belief, KeptAndPutBackGivesTheSameBits) {
    PoseEstimator estimator(kPart, kSolver, one_thread());
    for (int frame = 0; frame < 3; ++frame) estimator.update(observe_at(frame), motion(frame));
    const Belief kept = estimator.belief();
    std::vector<std::vector<double>> first, again;
    for (int frame = 3; frame < 6; ++frame)
        first.push_back(numbers_of(estimator.update(observe_at(frame), motion(frame))));
    estimator.reset();
    estimator.update(observe_nothing(), {});
    estimator.restore(kept);
    for (int frame = 3; frame < 6; ++frame)
        again.push_back(numbers_of(estimator.update(observe_at(frame), motion(frame))));
    EXPECT_EQ(first, again);
}

TEST(Belief, OneThatNoUpdateLeavesIsRefused) {
    PoseEstimator estimator(kPart, kSolver, one_thread());
    estimator.update(observe_at(0), {});
    Belief broken = estimator.belief();
    broken.tracked.reset();
    EXPECT_THROW(estimator.restore(broken), std::invalid_argument);
    broken = estimator.belief();
    broken.particles.negative_log_weights.pop_back();
    EXPECT_THROW(estimator.restore(broken), std::invalid_argument);
    EXPECT_NO_THROW(estimator.restore(Belief{}));
}

TEST(Belief, ACopyGoesOnByItself) {
    PoseEstimator estimator(kPart, kSolver, one_thread());
    estimator.update(observe_at(0), {});
    PoseEstimator copy = estimator;
    copy.reset();
    copy.update(observe_nothing(), {});
    EXPECT_EQ(copy.particles().size(), 0);
    EXPECT_GT(estimator.particles().size(), 0);
    EXPECT_LT(error_m(estimator.update(observe_at(1), motion_to(1)), 1), 0.001);
}

TEST(Belief, ANewOneKnowsNothingAndResetMakesOne) {
    PoseEstimator estimator(kPart, kSolver, one_thread());
    for (int frame = 0; frame < 7; ++frame) estimator.update(observe_at(frame), motion(frame));
    EXPECT_EQ(estimator.belief().lock.phase, Phase::kTracking);
    EXPECT_TRUE(estimator.belief().track);
    estimator.reset();
    const Belief& belief = estimator.belief();
    EXPECT_EQ(belief.particles.size(), 0);
    EXPECT_FALSE(belief.tracked || belief.track || belief.pose_before_loss);
    EXPECT_EQ(belief.lock.phase, Phase::kSearching);
    EXPECT_FALSE(belief.lock.verified || belief.lock.low_agreement);
    EXPECT_EQ(belief.lock.alternatives_tried, 0);
    EXPECT_EQ(belief.lock.alternatives_weight, 0.0);
    EXPECT_EQ(belief.lock.frames_unreplaced + belief.lock.frames_contradicted + belief.lock.frames_low_agreement, 0);
    EXPECT_EQ(belief.lock.accepted_evidence, 0.0);
    EXPECT_EQ(belief.step, 7U) << "random draws are not repeated";
}

}  // namespace
}  // namespace nearpose
