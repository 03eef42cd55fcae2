// How the estimator weighs its prediction against an image that contradicts it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <optional>

#include "core/base/random.hpp"
#include "core/estimator.hpp"
#include "tests/core/estimator_scene.hpp"

namespace nearpose {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)

// Only what is measured within the outermost pixels of the part's box on one side: left, right, top or bottom.
DepthImage strip_of(DepthImage image, const Mask& mask, int side) {
    constexpr int kWide = 10;  // pixels
    int first_u = mask.width, last_u = 0, first_v = mask.height, last_v = 0;
    for (int pixel = 0; pixel < mask.width * mask.height; ++pixel) {
        if (mask.value[pixel] == 0) continue;
        first_u = std::min(first_u, pixel % mask.width);
        last_u = std::max(last_u, pixel % mask.width);
        first_v = std::min(first_v, pixel / mask.width);
        last_v = std::max(last_v, pixel / mask.width);
    }
    for (int pixel = 0; pixel < mask.width * mask.height; ++pixel) {
        const int u = pixel % mask.width, v = pixel / mask.width;
        const int inwards[] = {u - first_u, last_u - u, v - first_v, last_v - v};
        if (inwards[side] < 0 || inwards[side] >= kWide) image.depth_m[pixel] = 0.0F;
    }
    return image;
}

TEST(Estimator, ACornerInViewDoesNotOverturnTheAcceptedPoseAndTheWholePartDoes) {
    // The part was moved by a fifth of its size. Where all but a corner of it is hidden, that may as well be an error
    // of the sensor.
    const Pose moved =
        Pose{Eigen::Quaterniond::Identity(), {0.2 * kPart->extent().diameter_m(), 0, 0.01}} * truth_at(0);
    Mask mask;
    const DepthImage all = render(*kPart, moved, kCamera, 0.9F, &mask);
    Mask corner = mask;
    int left = 60;
    for (std::uint8_t& value : corner.value) value = value != 0 && left-- > 0 ? value : 0;
    for (const bool whole : {false, true}) {
        PoseEstimator estimator(kPart, kSolver, small_options(method_default(), 0));
        for (int frame = 0; frame < 6; ++frame)
            EXPECT_EQ(estimator.update(observe_at(0), Pose::identity()).verdict, Verdict::kAccept) << frame;
        const Observation observation = make_observation(all, kCamera, whole ? mask : corner);
        estimator.update(observation, Pose::identity());
        const UpdateResult result = estimator.update(observation, Pose::identity());  // after a search
        const Eigen::Vector3d centre = kPart->extent().centre_in_object();
        const Pose expected = whole ? moved : truth_at(0);
        EXPECT_LT((result.camera_from_object * centre - expected * centre).norm(), 0.003) << whole;
        EXPECT_LT(angle_between(result.camera_from_object.rotation, expected.rotation), 0.05) << whole;
    }
}

TEST(Estimator, AStripInViewDoesNotPullThePoseOffThePrediction) {
    // After acceptance only a noisy strip along one side of the part is measured: too little for a fit, which would
    // slide along it.
    Mask mask;
    const DepthImage all = render(*kPart, truth_at(0), kCamera, 0.9F, &mask);
    for (const int side : {0, 1, 2, 3}) {
        PoseEstimator estimator(kPart, kSolver, small_options(method_default(), 0));
        for (int frame = 0; frame < 6; ++frame)
            EXPECT_EQ(estimator.update(observe_at(0), Pose::identity()).verdict, Verdict::kAccept) << frame;
        for (int frame = 0; frame < 8; ++frame) {
            DepthImage strip = strip_of(all, mask, side);
            RandomStream random(7, frame, side, RandomPurpose::kStart);
            for (float& depth_m : strip.depth_m) depth_m *= static_cast<float>(1.0 + 0.006 * random.gaussian());
            const Observation observation = make_observation(strip, kCamera, std::nullopt);
            const UpdateResult result = estimator.update(observation, Pose::identity());
            EXPECT_EQ(result.status, UpdateStatus::kEstimated) << "side " << side << ", frame " << frame;
            EXPECT_LT(error_m(result, 0), 0.001) << "side " << side << ", frame " << frame;
        }
    }
}

TEST(Estimator, APartThatStartsToMoveIsFollowedInTheFrameItself) {
    // The arm stands still. The motion is small enough to stay in the same mode, and much larger than the track's
    // error.
    PoseEstimator estimator(kPart, kSolver, small_options(method_default(), 0));
    for (int frame = 0; frame < 6; ++frame)
        EXPECT_EQ(estimator.update(observe_at(0), Pose::identity()).verdict, Verdict::kAccept) << frame;
    const double step_m = 0.025 * kPart->extent().diameter_m();
    const Eigen::Vector3d centre = kPart->extent().centre_in_object();
    Pose moved = truth_at(0);
    for (int frame = 0; frame < 3; ++frame) {
        moved.translation.x() += step_m;
        Mask mask;
        const DepthImage image = render(*kPart, moved, kCamera, 0.9F, &mask);
        const UpdateResult result = estimator.update(make_observation(image, kCamera, mask), Pose::identity());
        EXPECT_LT((result.camera_from_object * centre - moved * centre).norm(), 0.2 * step_m) << frame;
    }
}

TEST(Estimator, APartThatMovesAgainstTheMeasuredMotionIsFittedFromWhereItIs) {
    // The arm stands still while the part turns and drifts, as on a conveyor. The particles are pulled there from afar;
    // the refinement's gates are too narrow to pull the prediction.
    PoseEstimator estimator(kPart, kSolver, small_options(method_default(), 0));
    Pose truth = truth_at(0);
    const Eigen::Vector3d centre = kPart->extent().centre_in_object();
    const double step_m = 0.028 * kPart->extent().diameter_m();
    for (int frame = 0; frame < 7; ++frame) {
        Mask mask;
        const DepthImage image = render(*kPart, truth, kCamera, 0.9F, &mask);
        const UpdateResult result = estimator.update(make_observation(image, kCamera, mask), Pose::identity());
        EXPECT_LT((result.camera_from_object * centre - truth * centre).norm(), 0.00015) << frame;
        EXPECT_LT(angle_between(result.camera_from_object.rotation, truth.rotation), 0.002) << frame;
        truth = perturb_about(truth, (Twist() << 0, 0, 0.12, 0.7 * step_m, -0.7 * step_m, 0).finished(), centre);
    }
}

TEST(Estimator, AJoltThatNobodyMeasuredIsFollowedInTheFrameItself) {
    EstimatorOptions options = small_options(method_default(), 0);
    options.num_particles = 100;
    PoseEstimator estimator(kPart, kSolver, options);
    Pose truth = truth_at(0);
    double worst_m = 0.0;
    for (int frame = 0; frame < 20; ++frame) {
        constexpr int kConfirmed = 8;  // the track is confirmed by then, and few particles are left
        if (frame >= kConfirmed)
            truth.translation.x() += (frame % 2 == 0 ? 1.0 : -1.0) * 0.10 * kPart->extent().diameter_m();
        Mask mask;
        const DepthImage image = test::render(*kPart, truth, kCamera, 0.9F, &mask);
        const UpdateResult result = estimator.update(make_observation(image, kCamera, mask), {});
        const Eigen::Vector3d centre = kPart->extent().centre_in_object();
        if (frame >= kConfirmed)
            worst_m = std::max(worst_m, (result.camera_from_object * centre - truth * centre).norm());
    }
    EXPECT_LT(worst_m, 0.003);
}

TEST(Estimator, AnImageThatComesAgainNeitherConfirmsNorMovesAnything) {
    PoseEstimator estimator(kPart, kSolver, small_options(method_default(), 0));
    estimator.update(observe_at(0), {});
    for (int frame = 1; frame < 4; ++frame) estimator.update(observe_at(frame), motion_to(frame));
    const Lock before = estimator.belief().lock;
    for (int frame = 4; frame < 8; ++frame) {
        const UpdateResult hung = estimator.update(observe_at(3), motion_to(frame));
        EXPECT_EQ(hung.status, UpdateStatus::kPredicted);
        EXPECT_EQ(hung.verdict, Verdict::kContinue);
        ASSERT_EQ(hung.missing.size(), 1U);
        EXPECT_EQ(hung.missing[0].requirement, Requirement::kNewImage);
        EXPECT_EQ(hung.missing[0].value, frame - 3);
        EXPECT_LT(error_m(hung, frame), 0.001) << "the part stands still; the camera moves";
    }
    EXPECT_EQ(estimator.belief().lock.frames_unreplaced, before.frames_unreplaced);
    const UpdateResult seen = estimator.update(observe_at(8), motion_to(8));
    EXPECT_EQ(seen.status, UpdateStatus::kEstimated);
    EXPECT_LT(error_m(seen, 8), 0.001);
}

}  // namespace
}  // namespace nearpose
