#include "apps/error_measures/frame_errors.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/random.hpp"

namespace nearpose::evaluation {
namespace {

constexpr double kPi = std::numbers::pi;
const PinholeCamera kCamera{640, 480, 600.0, 610.0, 319.5, 239.5};

data_set::ModelInfo box_model() {
    data_set::ModelInfo model;
    model.diameter_m = 0.41;
    model.box_min_in_object_m = {-0.1, -0.1, 0.0};
    model.box_max_in_object_m = {0.1, 0.1, 0.3};
    return model;
}

// Points anywhere in the box: no symmetry.
std::vector<Eigen::Vector3d> some_vertices(int count = 300) {
    RandomStream random(5, 0, 0, RandomPurpose::kStart);
    std::vector<Eigen::Vector3d> vertices;
    for (int i = 0; i < count; ++i) {
        vertices.emplace_back(random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), random.uniform(0.0, 0.3));
    }
    return vertices;
}

Pose some_pose() {
    Twist twist;
    twist << 0.3, -0.7, 1.1, 0.02, -0.05, 0.6;
    return exp(twist);
}

// Off from some_pose() by a few centimetres and degrees.
Pose other_pose() {
    Twist twist;
    twist << 0.1, -0.05, 0.08, 0.01, 0.02, -0.015;
    return some_pose() * exp(twist);
}

PoseErrors errors_of(const Pose& estimate, const Pose& truth, const ModelShape& shape) {
    return *frame_errors({0, truth, std::nullopt}, EstimatedFrame{estimate, 1.0, 0.0, false, std::nullopt}, shape,
                         kCamera)
                .errors;
}

TEST(PoseError, IsMeasuredAtTheCentreOfTheBox) {
    Twist turn = Twist::Zero();
    turn[0] = 0.02;
    const Eigen::Vector3d centre(0.0, 0.0, 0.15);
    const PoseErrors error = pose_error(perturb_about(some_pose(), turn, centre), some_pose(), box_model());
    EXPECT_NEAR(error.translation_m, 0.0, 1e-12);
    EXPECT_NEAR(error.rotation_rad, 0.02, 1e-9);
}

TEST(PoseError, AxesAreTheCamerasAndTheirNormIsTheTotal) {
    const Pose truth = some_pose();
    const Eigen::Vector3d turn_in_camera(0.01, -0.02, 0.005), shift_in_camera(0.003, -0.001, 0.002);
    const Eigen::Vector3d centre = truth * Eigen::Vector3d(0.0, 0.0, 0.15);
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(turn_in_camera.norm(), turn_in_camera.normalized()));
    // Turned about the centre, then moved, both in the camera's axes.
    const Pose estimate{turn * truth.rotation, turn * (truth.translation - centre) + centre + shift_in_camera};
    const PoseErrors error = pose_error(estimate, truth, box_model());
    EXPECT_LT((error.rotation_in_camera_rad - turn_in_camera).norm(), 1e-12);
    EXPECT_LT((error.translation_in_camera_m - shift_in_camera).norm(), 1e-12);
    EXPECT_DOUBLE_EQ(error.rotation_rad, error.rotation_in_camera_rad.norm());
    EXPECT_DOUBLE_EQ(error.translation_m, error.translation_in_camera_m.norm());
}

TEST(PoseError, AnglesFromTinyToHalfTurns) {
    for (const double angle : {1e-9, 1e-6, 0.5, kPi - 1e-6, kPi}) {
        const Eigen::Quaterniond turn(Eigen::AngleAxisd(angle, Eigen::Vector3d(0.6, 0.0, 0.8)));
        const Pose truth = some_pose();
        const PoseErrors error = pose_error({turn * truth.rotation, truth.translation}, truth, box_model());
        EXPECT_NEAR(error.rotation_rad, angle, 1e-15 + 1e-12 * angle) << angle;
    }
}

TEST(PoseError, DiscreteSymmetriesAreForgiven) {
    data_set::ModelInfo model = box_model();
    const Eigen::AngleAxisd half_turn(kPi, Eigen::Vector3d::UnitZ());
    const Pose turned{Eigen::Quaterniond(half_turn), Eigen::Vector3d::Zero()};
    EXPECT_NEAR(pose_error(some_pose() * turned, some_pose(), model).rotation_rad, kPi, 1e-9);
    model.discrete_symmetries = {turned};
    EXPECT_NEAR(pose_error(some_pose() * turned, some_pose(), model).rotation_rad, 0.0, 1e-9);
}

TEST(PoseError, ContinuousSymmetriesAreSearchedToTheBottom) {
    data_set::ModelInfo model = box_model();
    model.continuous_symmetries = {{Eigen::Vector3d::UnitZ(), Eigen::Vector3d::Zero()}};
    Twist motion = Twist::Zero();
    motion[2] = 1.2345;  // about the axis: no error
    motion[5] = 0.004;   // along it
    const PoseErrors error = pose_error(some_pose() * exp(motion), some_pose(), model);
    EXPECT_NEAR(error.rotation_rad, 0.0, 1e-6);
    EXPECT_NEAR(error.translation_m, 0.004, 1e-9);
}

TEST(FrameErrors, AreZeroForEqualPoses) {
    const PoseErrors errors = errors_of(some_pose(), some_pose(), shape_of(box_model(), some_vertices()));
    for (const double value :
         {errors.translation_m, errors.rotation_rad, errors.add_m, errors.add_s_m, errors.mssd_m, errors.mspd_px}) {
        EXPECT_NEAR(value, 0.0, 1e-9);
    }
}

TEST(FrameErrors, OfATranslationAreItsLength) {
    Pose estimate = some_pose();
    const Eigen::Vector3d shift(0.003, -0.004, 0.012);  // of length 13 mm
    estimate.translation += shift;
    const PoseErrors errors = errors_of(estimate, some_pose(), shape_of(box_model(), some_vertices()));
    EXPECT_NEAR(errors.translation_m, 0.013, 1e-12);
    EXPECT_NEAR(errors.add_m, 0.013, 1e-12);
    EXPECT_NEAR(errors.mssd_m, 0.013, 1e-12);
    EXPECT_LT(errors.add_s_m, 0.013);
}

// ADD, ADD-S, MSSD and MSPD as written down, with every pair of vertices and every symmetry.
TEST(FrameErrors, AreThoseOfBruteForce) {
    data_set::ModelInfo model = box_model();
    model.discrete_symmetries = {
        {Eigen::Quaterniond(Eigen::AngleAxisd(kPi, Eigen::Vector3d::UnitX())), Eigen::Vector3d(0.0, 0.0, 0.3)}};
    model.continuous_symmetries = {{Eigen::Vector3d::UnitZ(), Eigen::Vector3d(0.01, 0.02, 0.0)}};
    const std::vector<Eigen::Vector3d> vertices = some_vertices(60);
    const ModelShape shape = shape_of(model, vertices);
    ASSERT_EQ(shape.symmetries.size(), 2U * 315U);
    for (const Pose& estimate :
         {other_pose(), some_pose() * shape.symmetries[400] * exp(Twist(Twist::Ones() * 0.01))}) {
        double add = 0.0, add_s = 0.0, mssd = 1e9, mspd = 1e9;
        for (const Eigen::Vector3d& vertex : vertices) {
            double nearest = 1e9;
            for (const Eigen::Vector3d& other : vertices) {
                nearest = std::min(nearest, (some_pose() * vertex - estimate * other).norm());
            }
            add_s += nearest / 60.0;
            add += (some_pose() * vertex - estimate * vertex).norm() / 60.0;
        }
        for (const Pose& symmetry : shape.symmetries) {
            double distance = 0.0, pixels = 0.0;
            for (const Eigen::Vector3d& vertex : vertices) {
                const Eigen::Vector3d a = estimate * vertex, b = some_pose() * (symmetry * vertex);
                distance = std::max(distance, (a - b).norm());
                pixels = std::max(pixels, (kCamera.project(a) - kCamera.project(b)).norm());
            }
            mssd = std::min(mssd, distance);
            mspd = std::min(mspd, pixels);
        }
        const PoseErrors errors = errors_of(estimate, some_pose(), shape);
        EXPECT_NEAR(errors.add_m, add, 1e-12);
        EXPECT_NEAR(errors.add_s_m, add_s, 1e-10);
        EXPECT_NEAR(errors.mssd_m, mssd, 1e-12);
        EXPECT_NEAR(errors.mspd_px, mspd, 1e-9);
        EXPECT_LE(errors.add_s_m, errors.add_m);
    }
}

TEST(FrameErrors, DoNotChangeUnderSymmetries) {
    data_set::ModelInfo model = box_model();
    model.continuous_symmetries = {{Eigen::Vector3d::UnitZ(), Eigen::Vector3d::Zero()}};
    const ModelShape shape = shape_of(model, some_vertices());
    const PoseErrors plain = errors_of(other_pose(), some_pose(), shape);
    const PoseErrors turned = errors_of(other_pose(), some_pose() * shape.symmetries[77], shape);
    EXPECT_NEAR(turned.mssd_m, plain.mssd_m, 1e-12);
    EXPECT_NEAR(turned.mspd_px, plain.mspd_px, 1e-9);
    EXPECT_NEAR(turned.translation_m, plain.translation_m, 1e-9);
    EXPECT_NEAR(turned.rotation_rad, plain.rotation_rad, 1e-7);
    EXPECT_GT(std::abs(turned.add_m - plain.add_m), 1e-3);  // which knows no symmetries
}

TEST(FrameErrors, SymmetriesAreCombinedAsTheToolkitDoes) {
    data_set::ModelInfo model = box_model();
    EXPECT_EQ(sampled_symmetries(model).size(), 1U);
    const Pose half_turn{Eigen::Quaterniond(Eigen::AngleAxisd(kPi, Eigen::Vector3d::UnitX())), {0.0, 0.0, 0.3}};
    model.discrete_symmetries = {half_turn};
    EXPECT_EQ(sampled_symmetries(model).size(), 2U);
    model.continuous_symmetries = {{Eigen::Vector3d::UnitZ(), Eigen::Vector3d(0.01, 0.0, 0.0)}};
    const std::vector<Pose> all = sampled_symmetries(model);
    ASSERT_EQ(all.size(), 630U);
    // The discrete one first, then a quarter of the way round about x = 10 mm.
    const Pose& late = all[315 + 63];  // 63 / 315 = 1 / 5
    const Eigen::Vector3d point(0.05, 0.02, 0.1);
    const Eigen::Vector3d flipped(0.05, -0.02, 0.2);
    const double c = std::cos(2.0 * kPi / 5.0), s = std::sin(2.0 * kPi / 5.0);
    const Eigen::Vector3d expected(0.01 + c * 0.04 + s * 0.02, s * 0.04 - c * 0.02, flipped.z());
    EXPECT_LT((late * point - expected).norm(), 1e-12);
}

TEST(FrameErrors, MahalanobisDistanceOfKnownCovariances) {
    const ModelShape shape = shape_of(box_model(), some_vertices(10));
    Twist sigmas, offset;
    sigmas << 0.01, 0.02, 0.04, 0.001, 0.002, 0.004;
    offset << 0.01, -0.02, 0.04, 0.002, 0.0, -0.008;  // 1, -1, 1, 2, 0, -2 sigmas
    EstimatedFrame estimate{some_pose(), 1.0, 0.0, false, Matrix6d(sigmas.cwiseAbs2().asDiagonal())};
    const TrueFrame truth{0, some_pose() * exp(offset), std::nullopt};
    const PoseErrors errors = *frame_errors(truth, estimate, shape, kCamera).errors;
    EXPECT_NEAR(errors.mahalanobis_squared.value(), 11.0, 1e-8);
    EXPECT_NEAR(errors.mahalanobis_rotation_squared.value(), 3.0, 1e-8);
    EXPECT_NEAR(errors.mahalanobis_translation_squared.value(), 8.0, 1e-8);

    // With correlations: against the inverse.
    Matrix6d factor = sigmas.asDiagonal();
    factor(3, 1) = 0.005;
    factor(5, 0) = -0.003;
    estimate.covariance = factor * factor.transpose();
    EXPECT_NEAR(frame_errors(truth, estimate, shape, kCamera).errors->mahalanobis_squared.value(),
                factor.inverse().operator*(offset).squaredNorm(), 1e-6);

    // A covariance that says nothing about a direction has no inverse.
    for (const double broken : {0.0, -1e-6, std::numeric_limits<double>::quiet_NaN()}) {
        (*estimate.covariance)(5, 5) = broken;
        EXPECT_FALSE(frame_errors(truth, estimate, shape, kCamera).errors->mahalanobis_squared.has_value()) << broken;
    }
    estimate.covariance = Matrix6d::Ones();
    EXPECT_FALSE(frame_errors(truth, estimate, shape, kCamera).errors->mahalanobis_squared.has_value());
}

TEST(FrameErrors, WithoutAPoseThereAreNone) {
    const TrueFrame truth{17, some_pose(), Visibility{0.5, 1e-4, 0.25}};
    const FrameErrors frame = frame_errors(truth, std::nullopt, shape_of(box_model(), some_vertices(5)), kCamera);
    EXPECT_EQ(frame.frame_id, 17);
    EXPECT_FALSE(frame.errors.has_value());
    EXPECT_LT(frame.time_s, 0.0);
    EXPECT_DOUBLE_EQ(frame.visibility->visible_fraction.value(), 0.25);
}

TEST(FrameErrors, APoseFarAwayIsMeasuredToo) {
    Pose estimate = some_pose();
    estimate.translation.x() += 1e25;  // whose square no float holds
    const PoseErrors errors = errors_of(estimate, some_pose(), shape_of(box_model(), some_vertices(10)));
    EXPECT_NEAR(errors.add_s_m / 1e25, 1.0, 1e-9);
}

TEST(Visibility, OfPointsInABoxAreItsDistanceAndVolume) {
    // A grid in a box of 40 x 20 x 10 mm, 0.5 m away: variance (n^2 - 1) / 12 * step^2 along each axis.
    std::vector<Eigen::Vector3f> points;
    constexpr int kSide = 11;
    const Eigen::Vector3d step(0.004, 0.002, 0.001);
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1.0, 2.0, 3.0).normalized()));
    for (int i = 0; i < kSide * kSide * kSide; ++i) {
        const Eigen::Vector3d cell(i % kSide - 5, i / kSide % kSide - 5, i / kSide / kSide - 5);
        points.emplace_back((turn * cell.cwiseProduct(step) + Eigen::Vector3d(0.0, 0.3, 0.4)).cast<float>());
    }
    const Visibility visibility = visibility_of(points);
    EXPECT_NEAR(visibility.distance_m, 0.5, 1e-7);
    const double deviations = std::pow((kSide * kSide - 1) / 12.0, 1.5) * step.prod();
    EXPECT_NEAR(visibility.visible_volume_m3, 4.0 / 3.0 * kPi * 8.0 * deviations, 1e-5 * deviations * 33.5);
    EXPECT_FALSE(visibility.visible_fraction.has_value());
}

TEST(Visibility, OfFlatSetsAndOfNothing) {
    EXPECT_DOUBLE_EQ(visibility_of({}).distance_m, 0.0);
    const Visibility flat = visibility_of({{0.0F, 0.0F, 1.0F}, {0.5F, 0.0F, 1.0F}, {0.0F, 0.5F, 1.0F}});
    EXPECT_NEAR(flat.visible_volume_m3, 0.0, 1e-12);
    EXPECT_DOUBLE_EQ(visibility_of({{0.0F, 0.0F, 0.75F}}).distance_m, 0.75);
}

}  // namespace
}  // namespace nearpose::evaluation
