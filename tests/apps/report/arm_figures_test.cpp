#include "apps/report/arm_figures.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <nlohmann/json.hpp>

#include "apps/base/degrees.hpp"
#include "core/base/random.hpp"
#include "core/world/arm_motion.hpp"
#include "tests/apps/support/contains.hpp"

namespace nearpose::report {
namespace {

const Eigen::Vector3d kCentre(0.05, -0.02, 0.03);
const Pose kPlace{Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized())), {0.5, -0.2, 0.1}};

LoggedFrame frame_at(int id, const Pose& world_from_object, Verdict verdict = Verdict::kAccept) {
    LoggedFrame frame;
    frame.frame_id = id;
    frame.status = "estimated";
    frame.verdict = verdict;
    frame.in_world = {world_from_object, 1e-8 * Matrix6d::Identity()};
    frame.arm = LoggedArm{};
    return frame;
}

Pose turned(double about_x_rad) {
    return {Eigen::Quaterniond(Eigen::AngleAxisd(about_x_rad, Eigen::Vector3d::UnitX())) * kPlace.rotation,
            kPlace.translation};
}

// Shifted, its centre by so much along the world's x.
Pose shifted(double x_m) {
    return {kPlace.rotation, kPlace.translation + x_m * Eigen::Vector3d::UnitX()};
}

TEST(CommonPlace, IsThatOfMostAcceptedFrames) {
    std::vector<LoggedFrame> log;
    for (int i = 0; i < 5; ++i) log.push_back(frame_at(i, turned(2.0), Verdict::kContinue));  // wrong at first
    log.push_back(frame_at(5, turned(1.5)));                                                  // once falsely accepted
    for (int i = 0; i < 4; ++i) log.push_back(frame_at(6 + i, kPlace));
    const CommonPlace common = *common_place(log, kCentre);
    EXPECT_LT((common.centre_in_world - kPlace * kCentre).norm(), 1e-12);
    EXPECT_LT(angle_between(common.world_from_object, kPlace.rotation), 1e-7);
}

TEST(CommonPlace, IsOfAllFramesWhereNoneWasAccepted) {
    EXPECT_FALSE(common_place({LoggedFrame{}}, kCentre));
    const std::vector<LoggedFrame> log = {frame_at(0, shifted(0.001), Verdict::kLost),
                                          frame_at(1, shifted(0.003), Verdict::kContinue),
                                          frame_at(2, shifted(0.002), Verdict::kContinue)};
    EXPECT_LT((common_place(log, kCentre)->centre_in_world - shifted(0.002) * kCentre).norm(), 1e-12);
}

TEST(PlaceDeviation, IsShiftAndTurnInTheWorldsAxes) {
    const CommonPlace common{kPlace * kCentre, kPlace.rotation};
    const PlaceDeviation shift = deviation_from(common, {shifted(0.004), Matrix6d::Zero()}, kCentre);
    EXPECT_LT((shift.shift_mm - Eigen::Vector3d(4.0, 0.0, 0.0)).norm(), 1e-9);
    EXPECT_LT(shift.turn_deg.norm(), 1e-9);
    const PlaceDeviation turn = deviation_from(common, {turned(0.01), Matrix6d::Zero()}, kCentre);
    EXPECT_LT((turn.turn_deg - Eigen::Vector3d(0.01 * kDegrees, 0.0, 0.0)).norm(), 1e-9);
}

TEST(PlaceDeviation, SampledPosesStrayByItsSigmas) {
    Matrix6d factor = Matrix6d::Zero();
    factor.diagonal() << 0.002, 0.004, 0.001, 0.0003, 0.0001, 0.0005;
    factor(4, 0) = 0.0002;  // translation and rotation depend on each other
    const CommonPlace common{kPlace * kCentre, kPlace.rotation};
    const PlaceDeviation stated = deviation_from(common, {kPlace, factor * factor.transpose()}, kCentre);
    RandomStream random(9, 0, 0, RandomPurpose::kDiffusion);
    constexpr int kDraws = 5000;
    Eigen::Array3d shifts = Eigen::Array3d::Zero(), turns = Eigen::Array3d::Zero();
    for (int i = 0; i < kDraws; ++i) {
        Twist draw;
        for (int k = 0; k < 6; ++k) draw[k] = random.gaussian();
        const PlaceDeviation drawn =
            deviation_from(common, {kPlace * exp(Twist(factor * draw)), Matrix6d::Zero()}, kCentre);
        shifts += drawn.shift_mm.array().square() / kDraws;
        turns += drawn.turn_deg.array().square() / kDraws;
    }
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(std::sqrt(shifts[axis]) / stated.sigma_mm[axis], 1.0, 0.04);
        EXPECT_NEAR(std::sqrt(turns[axis]) / stated.sigma_deg[axis], 1.0, 0.04);
    }
}

TEST(ArmConclusions, AreThatNothingContradictsTheArm) {
    const std::vector<LoggedFrame> log = {frame_at(0, kPlace), frame_at(1, kPlace)};
    EXPECT_EQ(conclusions(log), std::vector<std::string>{"Nothing contradicts the arm."});
    EXPECT_EQ(event_of(log.front()), ArmEvent::kNone);
}

TEST(ArmConclusions, NameTheCauseAndTheLastFrameWhereItHeld) {
    std::vector<LoggedFrame> log;
    for (int i = 0; i < 5; ++i) log.push_back(frame_at(10 + i, kPlace));
    log[1].arm->cause = log[2].arm->cause = to_string(Cause::kPrincipalPoint);
    log[2].arm->error_bound_m = 0.0042;
    log[3].missing = {{to_string(Requirement::kNewImage), "the image has not changed"}};
    log[4].missing = {{to_string(Requirement::kStands), "image and arm contradict each other"}};
    const std::vector<std::string> sentences = conclusions(log);
    ASSERT_EQ(sentences.size(), 3U);
    EXPECT_TRUE(contains(sentences[0], "principal point")) << sentences[0];
    EXPECT_TRUE(contains(sentences[0], "in 2 frames, last in frame 12")) << sentences[0];
    EXPECT_TRUE(contains(sentences[0], "4.2 mm")) << sentences[0];
    EXPECT_TRUE(contains(sentences[1], "in frame 13.")) << sentences[1];
    EXPECT_TRUE(contains(sentences[2], "in frame 14.")) << sentences[2];
    const ArmEvent expected[] = {ArmEvent::kNone, ArmEvent::kCause, ArmEvent::kCause, ArmEvent::kRepeated,
                                 ArmEvent::kContradicted};
    for (int i = 0; i < 5; ++i) EXPECT_EQ(event_of(log[i]), expected[i]) << i;
}

TEST(ArmConclusions, NameAMistakeInTheArmsMotionAndAPartThatMoves) {
    std::vector<LoggedFrame> log = {frame_at(0, kPlace), frame_at(1, kPlace)};
    log[0].arm->moves = to_string(MotionMistake::kInverted);
    log[0].arm->off_share = 1.83;
    log[1].arm->cause = to_string(Cause::kObjectMotion);
    EXPECT_EQ(event_of(log[0]), ArmEvent::kMotion);
    const std::vector<std::string> sentences = conclusions(log);
    ASSERT_EQ(sentences.size(), 2U);
    EXPECT_TRUE(contains(sentences[0], to_string(MotionMistake::kInverted))) << sentences[0];
    EXPECT_TRUE(contains(sentences[0], "1.83 of itself")) << sentences[0];
    EXPECT_EQ(sentences[1], "The part itself moves: found in frame 1.");
}

TEST(ArmJson, HasAPlaceForEachFrameAndNoneWithoutTheArm) {
    std::vector<LoggedFrame> log = {frame_at(0, kPlace), LoggedFrame{}, frame_at(2, shifted(0.002))};
    log[0].missing = {{to_string(Requirement::kStands), ""}};
    const auto arm = arm_json(log, kCentre);
    ASSERT_EQ(arm["frames"].size(), 3U);
    EXPECT_TRUE(arm["frames"][1].is_null());
    EXPECT_NEAR(arm["frames"][2]["shift_mm"][0].get<double>() - arm["frames"][0]["shift_mm"][0].get<double>(), 2.0,
                1e-9);
    EXPECT_EQ(arm["events"], nlohmann::json({"contradicted", "", ""}));
    EXPECT_TRUE(arm_json({LoggedFrame{}}, kCentre).is_null());
}

}  // namespace
}  // namespace nearpose::report
