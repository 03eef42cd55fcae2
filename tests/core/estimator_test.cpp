#include "core/estimator.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <thread>

#include "tests/core/estimator_scene.hpp"

namespace nearpose {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)

TEST(Estimator, DefaultMethodFindsAndTracksWithoutAPrior) {
    PoseEstimator estimator(kPart, kSolver, small_options(method_default(), 0));
    for (int frame = 0; frame < 6; ++frame) {
        const UpdateResult result =
            estimator.update(observe_at(frame), frame > 0 ? std::optional(motion_to(frame)) : std::nullopt);
        ASSERT_EQ(result.status, UpdateStatus::kEstimated);
        EXPECT_LT(error_m(result, frame), 0.001) << frame;
        EXPECT_LT(angle_between(result.camera_from_object.rotation, truth_at(frame).rotation), 0.01) << frame;
        EXPECT_GT(result.score, 0.9);
        EXPECT_GT(result.effective_sample_size, 0.99);
        EXPECT_GT(result.counts.pairs, 0);
    }
}

TEST(Estimator, TheSameBitsForAnyNumberOfThreads) {
    for (const Method& method : {method_default(), method_paper()}) {
        std::vector<std::vector<double>> runs;
        for (const int threads : {1, 2, 3}) {
            PoseEstimator estimator(kPart, kSolver, small_options(method, threads));
            std::vector<double> numbers;
            for (int frame = 0; frame < 4; ++frame) {
                // In the last one the part is searched for everywhere.
                if (frame == 3) estimator.reset();
                const UpdateResult result =
                    estimator.update(frame == 3 ? observe_without_mask(frame) : observe_at(frame), {});
                const auto& pose = result.camera_from_object;
                numbers.insert(numbers.end(), pose.rotation.coeffs().data(), pose.rotation.coeffs().data() + 4);
                numbers.insert(numbers.end(), pose.translation.data(), pose.translation.data() + 3);
                numbers.insert(numbers.end(), result.covariance.data(), result.covariance.data() + 36);
                numbers.push_back(result.effective_sample_size);
            }
            runs.push_back(numbers);
        }
        EXPECT_EQ(runs[0], runs[1]);
        EXPECT_EQ(runs[0], runs[2]);
    }
}

TEST(Estimator, TwoEstimatorsAtOnceGiveTheBitsOfTwoInTurn) {
    const auto run = [](std::uint64_t seed) {
        EstimatorOptions options = small_options(method_default(), 1);
        options.seed = seed;
        PoseEstimator estimator(kPart, kSolver, options);
        for (int frame = 0; frame < 2; ++frame) estimator.update(observe_at(frame), {});
        std::vector<double> numbers;
        for (const Pose& pose : estimator.particles().poses) numbers.push_back(pose.translation.x());
        return numbers;
    };
    std::vector<double> first, second;
    std::thread a([&] { first = run(1); }), b([&] { second = run(2); });
    a.join();
    b.join();
    EXPECT_EQ(first, run(1));
    EXPECT_EQ(second, run(2));
}

TEST(Estimator, AnotherSeedIsAnotherRun) {
    EstimatorOptions options = small_options(method_paper(), 1);
    PoseEstimator a(kPart, kSolver, options);
    options.seed = 2;
    PoseEstimator b(kPart, kSolver, options);
    EXPECT_NE(a.update(observe_at(0), {}).effective_sample_size, b.update(observe_at(0), {}).effective_sample_size);
}

TEST(Estimator, PaperMethodHoldsAGivenPose) {
    PoseEstimator estimator(kPart, kSolver, small_options(method_paper(), 0));
    estimator.reset(truth_at(0), {0.05, 0.005});
    for (int frame = 0; frame < 6; ++frame) {
        const UpdateResult result =
            estimator.update(observe_at(frame), frame > 0 ? std::optional(motion_to(frame)) : std::nullopt);
        EXPECT_LT(error_m(result, frame), 0.01) << frame;
        EXPECT_TRUE(result.modes.empty());
    }
}

TEST(Estimator, WithoutMeasuredNormalsItStillStarts) {
    // Every second column has no depth: no pixel has the neighbours that a normal needs.
    Mask mask;
    DepthImage image = test::render(*kPart, truth_at(0), kCamera, 0.9F, &mask);
    for (std::size_t pixel = 0; pixel < image.depth_m.size(); ++pixel)
        if (pixel % 3 != 0) image.depth_m[pixel] = 0.0F;
    PoseEstimator estimator(kPart, kSolver, small_options(method_default(), 0));
    for (const bool with_mask : {true, false}) {
        estimator.reset();
        EXPECT_NO_THROW(
            estimator.update(make_observation(image, kCamera, with_mask ? std::optional(mask) : std::nullopt), {}));
    }
}

TEST(Estimator, AMotionThatIsNotFiniteWasNotMeasured) {
    PoseEstimator estimator(kPart, kSolver, small_options(method_default(), 0));
    estimator.update(observe_at(0), {});
    Pose broken;
    broken.translation.x() = std::nan("");
    UpdateResult result;
    EXPECT_NO_THROW(result = estimator.update(observe_at(0), broken));
    EXPECT_LT(error_m(result, 0), 0.001);
    EXPECT_THROW(estimator.reset(broken, {}), std::invalid_argument);
}

TEST(Estimator, ResetForgets) {
    PoseEstimator estimator(kPart, kSolver, small_options(method_default(), 0));
    estimator.update(observe_at(0), {});
    estimator.reset();
    EXPECT_EQ(estimator.update(observe_nothing(), {}).status, UpdateStatus::kNoPose);
}

TEST(Estimator, AcceptsARightPoseAndSaysLostWhereNothingIsSeen) {
    PoseEstimator estimator(kPart, kSolver, small_options(method_default(), 0));
    EXPECT_EQ(estimator.update(observe_nothing(), {}).verdict, Verdict::kLost);
    UpdateResult result;
    for (int frame = 0; frame < 3; ++frame)
        result = estimator.update(observe_at(frame), frame > 0 ? std::optional(motion_to(frame)) : std::nullopt);
    EXPECT_EQ(result.verdict, Verdict::kAccept);
    EXPECT_GT(result.pixels.agreement(), 0.95);
    EXPECT_TRUE(result.observability.weak.empty());
    EXPECT_EQ(estimator.update(observe_nothing(), motion_to(3)).verdict, Verdict::kLost);
}

TEST(Estimator, WeightsOfModesSumToOneAndTheBestComesFirst) {
    PoseEstimator estimator(kPart, kSolver, small_options(method_default(), 0));
    const UpdateResult result = estimator.update(observe_at(0), {});
    ASSERT_FALSE(result.modes.empty());
    double sum = 0.0;
    for (const Mode& mode : result.modes) {
        sum += mode.weight;
        EXPECT_LE(mode.weight, result.modes.front().weight + 1e-12);
        EXPECT_GT(mode.covariance.diagonal().minCoeff(), 0.0);
    }
    EXPECT_NEAR(sum, 1.0, 1e-9);
}

TEST(Estimator, BeforeAFlatFaceTheArmsMotionHoldsWhatIsNotSeen) {
    // A slab's face fills the view: it says nothing of two slides and a turn. The camera goes along it.
    const auto slab =
        std::make_shared<test::BoxViewGenerator>(std::vector<test::Box>{{{-0.4, -0.4, -0.05}, {0.4, 0.4, 0.05}}});
    const auto truth = [](int frame) {
        Pose pose{Eigen::Quaterniond(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX())), {0.0, 0.0, 0.3}};
        pose.translation.x() += 0.005 * frame;
        return pose;
    };
    PoseEstimator estimator(slab, kSolver, small_options(method_default(), 0));
    estimator.reset(truth(0), {0.001, 0.0005});
    for (int frame = 0; frame < 15; ++frame) {
        DepthImage image = test::render(*slab, truth(frame), kCamera, 0.9F, nullptr);
        RandomStream noise(1, frame, 0, RandomPurpose::kDiffusion);  // without it all images would be one
        for (float& depth_m : image.depth_m) depth_m *= static_cast<float>(1.0 + 1e-5 * noise.gaussian());
        const Pose control = truth(frame) * truth(std::max(0, frame - 1)).inverse();
        const UpdateResult result =
            estimator.update(make_observation(image, kCamera, {}), frame > 0 ? std::optional(control) : std::nullopt);
        EXPECT_LT((result.camera_from_object.translation - truth(frame).translation).norm(), 0.001) << frame;
        EXPECT_LT(angle_between(result.camera_from_object.rotation, truth(frame).rotation), 0.01) << frame;
        const std::vector<std::string> open = {"slides along x", "slides along y", "turns about z"};
        std::vector<std::string> weak = result.observability.weak;
        std::sort(weak.begin(), weak.end());
        EXPECT_EQ(weak, open) << frame;
    }
}

TEST(Estimator, TellsANearlySymmetricPartApartOnlyWhereItsDetailIsInView) {
    // A plate with one small tower, off its middle: from above a half turn is another pose, from below it is the same.
    const auto plate = std::make_shared<test::BoxViewGenerator>(
        std::vector<test::Box>{{{-0.10, -0.07, -0.03}, {0.10, 0.07, 0.03}}, {{0.04, 0.02, 0.03}, {0.08, 0.06, 0.06}}});
    EstimatorOptions options = small_options(method_default(), 0);
    options.symmetries.near_symmetries = {
        {Eigen::Quaterniond(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitZ())), {0, 0, 0}}};
    for (const bool from_above : {true, false}) {
        // Seen askew, so that faces across all axes are in view.
        const Eigen::Vector3d tilt = 0.4 * Eigen::Vector3d(1.0, 0.7, 0.0).normalized();
        const Eigen::Quaterniond tilted(Eigen::AngleAxisd(tilt.norm(), tilt.normalized()));
        const Eigen::Quaterniond over(Eigen::AngleAxisd(from_above ? M_PI : 0.0, Eigen::Vector3d::UnitX()));
        const Pose truth{tilted * over, {0.0, 0.0, 0.45}};
        Mask mask;
        const DepthImage image = test::render(*plate, truth, kCamera, 0.9F, &mask);
        PoseEstimator estimator(plate, kSolver, options);
        UpdateResult result;
        for (int frame = 0; frame < 3; ++frame)
            result = estimator.update(make_observation(image, kCamera, mask), Pose::identity());
        const double best = result.modes.front().weight;
        if (from_above) {
            EXPECT_EQ(result.verdict, Verdict::kAccept);
            EXPECT_LT(angle_between(result.camera_from_object.rotation, truth.rotation), 0.02);
            EXPECT_GT(best, 0.99);
        } else {
            EXPECT_EQ(result.verdict, Verdict::kContinue);
            EXPECT_LT(best, 0.9) << "both turns are told, with their weights";
        }
    }
}

TEST(Estimator, BadOptionsNameTheFieldAndTheBound) {
    const auto message = [](EstimatorOptions options) {
        try {
            PoseEstimator(kPart, kSolver, options);
        } catch (const std::invalid_argument& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    EstimatorOptions options;
    EXPECT_EQ(message(options), "");
    options.num_particles = 0;
    EXPECT_EQ(message(options), "num_particles is 0, but must be in 1..1e+06");
    options = {};
    options.method.step.step_size = std::nan("");
    EXPECT_NE(message(options).find("step.step_size"), std::string::npos);
    options = {};
    options.tolerance.translation_m = 0.0;
    EXPECT_NE(message(options).find("tolerance.translation_m is 0"), std::string::npos);
    options = {};
    options.motion_noise.fraction = -1.0;
    EXPECT_NE(message(options).find("motion_noise.fraction is -1"), std::string::npos);
    EXPECT_THROW(PoseEstimator(nullptr, kSolver, {}), std::invalid_argument);
}

}  // namespace
}  // namespace nearpose
