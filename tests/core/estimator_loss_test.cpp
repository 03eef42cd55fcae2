// What the estimator does where it has no pose, a wrong one or an unverified one.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/estimator.hpp"
#include "tests/core/estimator_scene.hpp"

namespace nearpose {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)

TEST(Estimator, NothingSeenYetIsNoPoseAndLaterThePredictionStandsIn) {
    PoseEstimator estimator(kPart, kSolver, small_options(method_default(), 0));
    EXPECT_EQ(estimator.update(observe_nothing(), {}).status, UpdateStatus::kNoPose);
    EXPECT_EQ(estimator.update(observe_at(0), {}).status, UpdateStatus::kEstimated);
    const UpdateResult hidden = estimator.update(observe_nothing(), motion_to(1));
    EXPECT_EQ(hidden.status, UpdateStatus::kPredicted);
    EXPECT_LT(error_m(hidden, 1), 0.001) << "moved with the camera";
    EXPECT_EQ(hidden.score, 0.0);
    const UpdateResult again = estimator.update(observe_at(2), motion_to(2));
    EXPECT_EQ(again.status, UpdateStatus::kEstimated);
    EXPECT_LT(error_m(again, 2), 0.001);
}

TEST(Estimator, AWallIsNotThePartHoweverNearItComes) {
    for (const double tilt : {0.0, 0.4}) {
        PoseEstimator estimator(kPart, kSolver, small_options(method_default(), 0));
        for (double distance_m = 0.45; distance_m > 0.12; distance_m -= 0.04) {
            const Eigen::Vector3d normal = Eigen::Vector3d(std::sin(tilt), 0.0, std::cos(tilt));
            DepthImage wall{kCamera.width, kCamera.height, {}};
            for (int pixel = 0; pixel < 160 * 120; ++pixel)
                wall.depth_m.push_back(
                    static_cast<float>(distance_m / normal.dot(kCamera.ray(pixel % 160, pixel / 160))));
            const UpdateResult result = estimator.update(make_observation(wall, kCamera, std::nullopt), {});
            EXPECT_NE(result.verdict, Verdict::kAccept) << "a wall at " << distance_m << " m, tilted by " << tilt;
            EXPECT_LE(result.log_odds_present, 0.0);
            // At 0.17 m the image is 0.18 x 0.14 m wide, as a face of the part: nothing tells them apart.
            const Verdict expected = distance_m > 0.18 ? Verdict::kLost : result.verdict;
            EXPECT_EQ(result.verdict, expected) << "a wall at " << distance_m << " m, tilted by " << tilt;
        }
    }
}

TEST(Estimator, SaysWhatKeepsAPoseFromBeingAccepted) {
    EstimatorOptions options = small_options(method_default(), 0);
    options.tolerance = {1e-5, 1e-5};
    PoseEstimator estimator(kPart, kSolver, options);
    UpdateResult result;
    for (int frame = 0; frame < 3; ++frame)
        result = estimator.update(observe_at(frame), frame == 0 ? std::nullopt : std::optional(motion_to(frame)));
    EXPECT_EQ(result.verdict, Verdict::kContinue);
    ASSERT_EQ(result.missing.size(), 2U);
    EXPECT_EQ(result.missing[0].requirement, Requirement::kTranslation);
    EXPECT_EQ(result.missing[0].limit, 1e-5);
    EXPECT_EQ(result.missing[1].requirement, Requirement::kRotation);
}

TEST(Estimator, SomethingElseInViewIsNotTheObject) {
    // A bare wall takes the object's place: no pose explains it, so the result is the prediction.
    const DepthImage wall{kCamera.width, kCamera.height, std::vector<float>(160 * 120, 0.9F)};
    PoseEstimator estimator(kPart, kSolver, small_options(method_default(), 0));
    const Mask somewhere{kCamera.width, kCamera.height, [] {
                             std::vector<std::uint8_t> value(160 * 120, 0);
                             for (int v = 40; v < 80; ++v) std::fill_n(value.begin() + v * 160 + 60, 40, 1);
                             return value;
                         }()};
    EXPECT_EQ(estimator.update(observe_at(0), {}).status, UpdateStatus::kEstimated);
    DepthImage tilted = wall;  // no face of the part is as large, and it is far behind
    for (std::size_t pixel = 0; pixel < tilted.depth_m.size(); ++pixel)
        tilted.depth_m[pixel] = 1.5F + 0.01F * static_cast<float>(pixel % 160);
    const UpdateResult hidden = estimator.update(make_observation(tilted, kCamera, somewhere), motion_to(1));
    EXPECT_EQ(hidden.status, UpdateStatus::kPredicted);
    EXPECT_EQ(hidden.score, 0.0);
    EXPECT_LT(error_m(hidden, 1), 0.001);
    const UpdateResult again = estimator.update(observe_at(2), motion_to(2));
    EXPECT_EQ(again.status, UpdateStatus::kEstimated);
    EXPECT_LT(error_m(again, 2), 0.001) << "the particles were not pulled away";
}

TEST(Estimator, AWrongTrackedModeIsReplaced) {
    // Started half a turn off with a narrow spread: the paper's filter would stay there.
    PoseEstimator estimator(kPart, kSolver, small_options(method_default(), 0));
    const Pose wrong =
        perturb_about(truth_at(0), (Twist() << 0, 0, M_PI, 0, 0, 0).finished(), kPart->extent().centre_in_object());
    estimator.reset(wrong, {0.01, 0.001});
    UpdateResult result;
    for (int frame = 0; frame < 4; ++frame)
        result = estimator.update(observe_at(frame), frame > 0 ? std::optional(motion_to(frame)) : std::nullopt);
    EXPECT_LT(error_m(result, 3), 0.001);
    EXPECT_LT(angle_between(result.camera_from_object.rotation, truth_at(3).rotation), 0.02);
}

TEST(Estimator, FindsTheObjectAgainWhereItWasPutDown) {
    PoseEstimator estimator(kPart, kSolver, small_options(method_default(), 0));
    estimator.update(observe_at(0), {});
    const Pose elsewhere = perturb_about(truth_at(0), (Twist() << 0, 0, 2.0, 0.05, -0.04, 0.02).finished(),
                                         kPart->extent().centre_in_object());
    Mask mask;
    const DepthImage image = test::render(*kPart, elsewhere, kCamera, 0.9F, &mask);
    UpdateResult result;
    // It is acted on when it has stood there for some frames.
    for (int frame = 0; frame < 8; ++frame)
        result = estimator.update(make_observation(image, kCamera, mask), Pose::identity());
    EXPECT_LT(angle_between(result.camera_from_object.rotation, elsewhere.rotation), 0.02);
    EXPECT_EQ(result.verdict, Verdict::kAccept);
}

TEST(Estimator, AfterFramesOfNonsenseItIsBackInTheFirstRightOne) {
    PoseEstimator estimator(kPart, kSolver, small_options(method_default(), 0));
    for (int frame = 0; frame < 7; ++frame)
        estimator.update(observe_at(frame), frame > 0 ? std::optional(motion_to(frame)) : std::nullopt);
    DepthImage wall{kCamera.width, kCamera.height, std::vector<float>(160 * 120, 0.45F)};
    for (int frame = 7; frame < 10; ++frame)
        EXPECT_NE(estimator.update(make_observation(wall, kCamera, {}), motion_to(frame)).verdict, Verdict::kAccept);
    const UpdateResult back = estimator.update(observe_at(10), motion_to(10));
    EXPECT_LT(error_m(back, 10), 0.002);
}

TEST(Estimator, AnUnverifiedPoseIsSearchedForAnewAtFirstAndNowAndThen) {
    // Every seventeenth pixel of the part is measured far behind it: the model is not quite the part. The sensor's
    // edges are sharp, so that each of them counts.
    Mask mask;
    DepthImage image = render(*kPart, truth_at(0), kCamera, 0.9F, &mask);
    int on_part = 0;
    for (std::size_t pixel = 0; pixel < mask.value.size(); ++pixel)
        if (mask.value[pixel] != 0 && on_part++ % 17 == 0) image.depth_m[pixel] += 0.05F;
    ObservationOptions sharp;
    sharp.sensor.edge_pixels = 0.0;
    const Observation observation = make_observation(image, kCamera, mask, sharp);
    for (const bool searches_anew : {true, false}) {
        EstimatorOptions options = small_options(method_default(), 0);
        options.method.relocalisation.low_agreement = searches_anew;
        PoseEstimator estimator(kPart, kSolver, options);
        std::vector<int> searched;
        for (int frame = 0; frame < 34; ++frame) {
            const UpdateResult result = estimator.update(observation, Pose::identity());
            EXPECT_GT(result.pixels.agreement(), 0.8);
            EXPECT_LT(result.pixels.agreement(), 0.93);
            EXPECT_EQ(result.verdict, Verdict::kContinue);
            EXPECT_LT(error_m(result, 0), 0.002) << frame;
            if (result.effort.starts > 0) searched.push_back(frame);
        }
        EXPECT_EQ(searched, searches_anew ? (std::vector<int>{0, 1, 2, 3, 4, 16, 32}) : std::vector<int>{0});
    }
}

}  // namespace
}  // namespace nearpose
