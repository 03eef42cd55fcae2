#include "core/fit/joint_fit.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <stdexcept>
#include <string>

#include "core/base/random.hpp"
#include "core/fit/sensor_field.hpp"
#include "tests/core/analytic_part.hpp"

namespace nearpose {
namespace {

const test::BoxViewGenerator kPart(test::asymmetric_part());
const test::GaussNewtonSolver kSolver;
const PinholeCamera kCamera{160, 120, 150.0, 150.0, 79.5, 59.5};
const Pose kTruth{Eigen::Quaterniond(Eigen::AngleAxisd(2.5, Eigen::Vector3d(1, 0.4, 0.2).normalized())),
                  {0.01, -0.01, 0.40}};
const GradientStep kStep;

SensorModel sensor_of_test() {
    SensorModel sensor;
    sensor.systematic_length_pixels = 20.0;
    sensor.systematic_fitted = 1.0;
    sensor.scale_fitted = 1.0;
    sensor.systematic_fine_sigma_m = 0.0;
    sensor.lateral_sigma_pixels = 0.0;
    return sensor;
}

// Depth of the part with white noise, an error field over the image and an error of scale.
Observation observe_with_errors(const SensorModel& sensor, const Eigen::VectorXd& errors, std::uint64_t seed) {
    Mask mask;
    DepthImage image = test::render(kPart, kTruth, kCamera, 0.9F, &mask);
    const SensorField field = field_over(kCamera, sensor);
    RandomStream random(seed, 0, 0, RandomPurpose::kDiffusion);
    for (int pixel = 0; pixel < kCamera.width * kCamera.height; ++pixel) {
        float& depth_m = image.depth_m[pixel];
        const SensorField::Row row = field.row_at(pixel % kCamera.width, pixel / kCamera.width, depth_m);
        double error_m = sensor.sigma_m(depth_m) * random.gaussian();
        for (int i = 0; i < 5; ++i) error_m += row.factors[i] * errors[row.unknowns[i]];
        depth_m += static_cast<float>(error_m);
    }
    ObservationOptions options;
    options.sensor = sensor;
    return make_observation(image, kCamera, mask, options);
}

JointFit fit(const Observation& observation, const Pose& start, const FitOptions& options = {}) {
    const ObservedGrid observed = observe(observation, {0, 0, 1, kCamera.width, kCamera.height});
    return fit_jointly(start, {kPart, kSolver, observation, observed, kStep, Cost::kPixels, {}, true}, options);
}

Twist error_of(const Pose& pose) {
    const Eigen::Vector3d centre = kPart.extent().centre_in_object();
    Twist error;
    error.head<3>() = log(Pose{pose.rotation.conjugate() * kTruth.rotation, {0, 0, 0}}).head<3>();
    error.tail<3>() = pose.rotation.conjugate() * (kTruth * centre - pose * centre);
    return error;
}

Pose near_truth() {
    Twist off;
    off << 0.004, -0.003, 0.005, 0.001, 0.0008, -0.001;
    return perturb_about(kTruth, off, kPart.extent().centre_in_object());
}

TEST(SensorField, InterpolatesBetweenNodesWithConstantVariance) {
    const SensorField field = field_over(kCamera, sensor_of_test());
    for (const double u : {0.0, 13.0, 29.9, 30.0, 101.5, 159.0}) {
        for (const double v : {0.0, 44.4, 119.0}) {
            const SensorField::Row row = field.row_at(u, v, 0.5);
            double squares = 0.0;
            for (int i = 0; i < 4; ++i) {
                squares += row.factors[i] * row.factors[i];
                EXPECT_GE(row.unknowns[i], 0);
                EXPECT_LT(row.unknowns[i], field.num_nodes());
            }
            EXPECT_NEAR(squares, 1.0, 1e-12);
            EXPECT_EQ(row.unknowns[4], field.num_nodes());
            EXPECT_EQ(row.factors[4], 0.5) << "the scale's error is in proportion to the depth";
        }
    }
}

TEST(JointFit, FindsTheExactPoseOfAnExactImage) {
    SensorModel sensor = sensor_of_test();
    Mask mask;
    const DepthImage image = test::render(kPart, kTruth, kCamera, 0.9F, &mask);
    ObservationOptions options;
    options.sensor = sensor;
    const JointFit fitted = fit(make_observation(image, kCamera, mask, options), near_truth());
    EXPECT_LT(error_of(fitted.camera_from_object).tail<3>().norm(), 2e-5);
    EXPECT_LT(error_of(fitted.camera_from_object).head<3>().norm(), 2e-4);
}

TEST(JointFit, TheCovarianceIsThatOfTheErrorsOverManySensors) {
    // Each trial is another sensor: its field and scale are drawn from their prior.
    const SensorModel sensor = sensor_of_test();
    const SensorField field = field_over(kCamera, sensor);
    const Eigen::VectorXd variances = prior_variances(field, sensor);
    constexpr int kTrials = 60;
    double mean_squared_distance = 0.0;
    for (int trial = 0; trial < kTrials; ++trial) {
        RandomStream random(7, trial, 0, RandomPurpose::kStart);
        Eigen::VectorXd errors(field.num_unknowns());
        for (int i = 0; i < errors.size(); ++i) errors[i] = std::sqrt(variances[i]) * random.gaussian();
        const JointFit fitted = fit(observe_with_errors(sensor, errors, 100 + trial), near_truth());
        const Twist error = error_of(fitted.camera_from_object);
        mean_squared_distance += error.dot(fitted.covariance.ldlt().solve(error)) / kTrials;
    }
    // Chi-square of 6 degrees: mean 6, standard deviation of this mean 0.45; robust weights cost a little.
    EXPECT_GT(mean_squared_distance, 3.5);
    EXPECT_LT(mean_squared_distance, 8.5);
}

TEST(JointFit, ASensorWithSharedErrorsIsTrustedLess) {
    SensorModel exact = sensor_of_test();
    exact.systematic_sigma_m = 0.0;
    exact.depth_scale_sigma = 0.0;
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(field_over(kCamera, exact).num_unknowns());
    const Matrix6d alone = fit(observe_with_errors(exact, none, 1), kTruth).covariance;
    const Matrix6d shared = fit(observe_with_errors(sensor_of_test(), none, 1), kTruth).covariance;
    for (int i = 0; i < 6; ++i) EXPECT_GT(shared(i, i), 2.0 * alone(i, i)) << i;
}

// A part that was made larger than its CAD by a share of itself.
test::BoxViewGenerator enlarged_part(double share) {
    std::vector<test::Box> boxes = test::asymmetric_part();
    const Eigen::Vector3d centre = kPart.extent().centre_in_object();
    for (test::Box& box : boxes) {
        box.min += share * (box.min - centre);
        box.max += share * (box.max - centre);
    }
    return test::BoxViewGenerator(boxes);
}

Observation observe_exactly(const test::BoxViewGenerator& part, const SensorModel& sensor) {
    Mask mask;
    const DepthImage image = test::render(part, kTruth, kCamera, 0.9F, &mask);
    ObservationOptions options;
    options.sensor = sensor;
    return make_observation(image, kCamera, mask, options);
}

TEST(JointFit, TheConstantCovarianceIsThatOfAPartLargerThanItsCad) {
    constexpr double kShare = 0.001;
    SensorModel sensor = sensor_of_test();
    sensor.systematic_sigma_m = 0.0;  // so that only the pose can explain the difference
    sensor.depth_scale_sigma = 0.0;
    sensor.focal_length_sigma = 0.0;  // and the part's scale is the only constant error
    sensor.image_shift_sigma_pixels = 0.0;
    const JointFit exact = fit(observe_exactly(kPart, sensor), kTruth);
    const JointFit larger = fit(observe_exactly(enlarged_part(kShare), sensor), kTruth);
    const Twist step = error_of(larger.camera_from_object) - error_of(exact.camera_from_object);
    // The covariance is the square of such a step for one sigma, 0.1 %.
    const Matrix6d squared = step * step.transpose();
    EXPECT_GT(step.tail<3>().norm(), 2e-5);
    const Eigen::Matrix3d of_translation = squared.bottomRightCorner<3, 3>();
    const Eigen::Matrix3d predicted = larger.constant_covariance.bottomRightCorner<3, 3>();
    EXPECT_LT((predicted - of_translation).norm(), 0.4 * of_translation.norm());
}

// The same law for the camera: what a fit with a wrong calibration is off by is one sigma of the constant covariance.
TEST(JointFit, TheConstantCovarianceIsThatOfACameraThatDiffersFromItsCalibration) {
    SensorModel sensor = sensor_of_test();
    sensor.systematic_sigma_m = 0.0;
    sensor.depth_scale_sigma = 0.0;
    FitOptions options;
    options.part_scale_sigma = 0.0;
    const auto observe_with = [&](const PinholeCamera& calibration) {
        Mask mask;
        const DepthImage image = test::render(kPart, kTruth, kCamera, 0.9F, &mask);
        ObservationOptions observed;
        observed.sensor = sensor;
        return make_observation(image, calibration, mask, observed);
    };
    const auto expect_step = [&](const PinholeCamera& calibration) {
        const JointFit exact = fit(observe_with(kCamera), kTruth, options);
        const JointFit wrong = fit(observe_with(calibration), kTruth, options);
        const Twist step = error_of(wrong.camera_from_object) - error_of(exact.camera_from_object);
        const Eigen::Matrix3d seen = step.tail<3>() * step.tail<3>().transpose();
        const Eigen::Matrix3d predicted = exact.constant_covariance.bottomRightCorner<3, 3>();
        EXPECT_GT(step.tail<3>().norm(), 5e-5);
        EXPECT_LT((predicted - seen).norm(), 0.4 * seen.norm()) << predicted << "\n\n" << seen;
    };
    PinholeCamera longer = kCamera;
    longer.fx *= 1.002;
    longer.fy *= 1.002;
    sensor.focal_length_sigma = 0.002;
    sensor.image_shift_sigma_pixels = 0.0;
    expect_step(longer);
}

TEST(JointFit, AFieldLargerThanTheSensorModelsWidensTheCovariance) {
    const SensorModel sensor = sensor_of_test();
    const SensorField field = field_over(kCamera, sensor);
    const Eigen::VectorXd variances = prior_variances(field, sensor);
    constexpr int kTrials = 40;
    constexpr double kLarger = 4.0;
    double mean_squared_distance = 0.0;
    for (int trial = 0; trial < kTrials; ++trial) {
        RandomStream random(9, trial, 0, RandomPurpose::kStart);
        Eigen::VectorXd errors = Eigen::VectorXd::Zero(field.num_unknowns());
        for (int i = 0; i < field.num_nodes(); ++i) errors[i] = kLarger * std::sqrt(variances[i]) * random.gaussian();
        const JointFit fitted = fit(observe_with_errors(sensor, errors, 300 + trial), near_truth());
        const Twist error = error_of(fitted.camera_from_object);
        mean_squared_distance += error.dot(fitted.covariance.ldlt().solve(error)) / kTrials;
    }
    EXPECT_LT(mean_squared_distance, 15.0) << "the covariance of the sensor model alone would give up to 6 * 4^2";
}

TEST(JointFit, TellsTheSizeOfTheFieldThatTheImageShows) {
    const SensorModel sensor = sensor_of_test();
    const SensorField field = field_over(kCamera, sensor);
    constexpr int kTrials = 10;
    for (const double times : {0.0, 1.0, 3.0}) {
        const double planted_m = times * sensor.systematic_sigma_m;
        double mean_m = 0.0;
        for (int trial = 0; trial < kTrials; ++trial) {
            RandomStream random(11, trial, 0, RandomPurpose::kStart);
            Eigen::VectorXd errors = Eigen::VectorXd::Zero(field.num_unknowns());
            for (int i = 0; i < field.num_nodes(); ++i) errors[i] = planted_m * random.gaussian();
            mean_m += fit(observe_with_errors(sensor, errors, 500 + trial), near_truth()).shared_sigma_m / kTrials;
        }
        EXPECT_NEAR(mean_m, planted_m, 0.25 * planted_m + 0.4 * sensor.systematic_sigma_m) << times;
    }
}

TEST(JointFit, APartThatDiffersFromItsCadIsTrustedLess) {
    const SensorModel sensor = sensor_of_test();
    std::vector<test::Box> boxes = test::asymmetric_part();
    boxes[1].max += Eigen::Vector3d(0.002, 0.0, 0.003);  // two towers that were cast differently
    boxes[2].max += Eigen::Vector3d(0.0, 0.002, -0.002);
    const JointFit right = fit(observe_exactly(kPart, sensor), kTruth);
    const JointFit wrong = fit(observe_exactly(test::BoxViewGenerator(boxes), sensor), kTruth);
    for (int i = 0; i < 6; ++i) EXPECT_GT(wrong.covariance(i, i), right.covariance(i, i)) << i;
}

TEST(JointFit, ThePartsScaleIsAsUncertainAsTheOptionsSay) {
    SensorModel sensor = sensor_of_test();
    sensor.focal_length_sigma = 0.0;
    sensor.image_shift_sigma_pixels = 0.0;
    const Observation observation = observe_exactly(kPart, sensor);
    FitOptions options;
    const Matrix6d once = fit(observation, kTruth, options).constant_covariance;
    options.part_scale_sigma *= 2.0;
    const Matrix6d twice = fit(observation, kTruth, options).constant_covariance;
    EXPECT_LT((twice - 4.0 * once).norm(), 1e-12 * twice.norm());
}

TEST(JointFit, OptionsOutOfBoundsAreRefusedByName) {
    FitOptions options;
    EXPECT_NO_THROW(validate(options));
    options.rays.huber_sigmas = 0.0;
    try {
        validate(options);
        FAIL() << "accepted";
    } catch (const std::invalid_argument& error) {
        EXPECT_NE(std::string(error.what()).find("fit.rays.huber_sigmas"), std::string::npos) << error.what();
    }
}

}  // namespace
}  // namespace nearpose
