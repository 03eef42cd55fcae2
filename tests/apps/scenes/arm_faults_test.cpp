#include "apps/scenes/arm_faults.hpp"

#include <gtest/gtest.h>

#include "apps/scenes/arm.hpp"
#include "core/base/random.hpp"

namespace nearpose::simulate {
namespace {

constexpr int kFrames = 12;

std::vector<Pose> some_motion() {
    std::vector<Pose> motion;
    RandomStream random(7, 0, 0, RandomPurpose::kStart);
    const Pose start{random.rotation(), random.direction()};
    const Twist step = (Twist() << 0.03, -0.02, 0.01, 0.005, 0.01, -0.02).finished();
    for (int i = 0; i < kFrames; ++i) motion.push_back(start * exp(step * i));
    return motion;
}

std::vector<Pose> with(const std::string& fault, std::uint64_t seed = 3) {
    return with_arm_faults(some_motion(), {parse_fault(fault)}, seed);
}

double between(const Pose& a, const Pose& b) {
    return log(a.inverse() * b).norm();
}

TEST(ArmFaults, LeaveFramesAloneThatTheyDoNotHave) {
    const std::vector<Pose> exact = some_motion();
    for (const FaultRule& rule : fault_rules()) {
        const bool of_arm = rule.kind >= FaultKind::kArmInverted && rule.kind <= FaultKind::kHandEye;
        const std::string value = *rule.value == '\0' ? "" : (rule.low > 1.0 ? ":90" : rule.whole ? ":1" : ":0.5");
        const std::vector<Pose> motion = with(rule.name + value + "@4-6");
        int changed = 0;
        for (int i = 0; i < kFrames; ++i) {
            const auto place = static_cast<std::size_t>(i);
            const bool same = motion[place].rotation.coeffs() == exact[place].rotation.coeffs() &&
                              motion[place].translation == exact[place].translation;
            EXPECT_TRUE(same || (of_arm && i >= 4 && i <= 6)) << rule.name << i;
            changed += same ? 0 : 1;
        }
        EXPECT_EQ(changed, !of_arm ? 0 : (rule.kind == FaultKind::kArmOutlier ? 1 : 3)) << rule.name;
    }
}

TEST(ArmFaults, InverseAndTransposeAreWhatTheyAreCalled) {
    const std::vector<Pose> exact = some_motion(), inverted = with("arm-inverted@all"),
                            transposed = with("arm-transposed@all"), units = with("arm-units@all");
    for (std::size_t i = 0; i < exact.size(); ++i) {
        EXPECT_LT(log(inverted[i] * exact[i]).norm(), 1e-12);
        EXPECT_LT((transposed[i].rotation_matrix() - exact[i].rotation_matrix().transpose()).norm(), 1e-12);
        EXPECT_EQ(transposed[i].translation, exact[i].translation);
        EXPECT_EQ(units[i].translation, 1e-3 * exact[i].translation);
        EXPECT_EQ(units[i].rotation.coeffs(), exact[i].rotation.coeffs());
    }
}

TEST(ArmFaults, LateAndFrozenArmsReportEarlierPoses) {
    const std::vector<Pose> exact = some_motion(), late = with("arm-late:2@5-"), half = with("arm-late:0.5@5-"),
                            frozen = with("arm-frozen@5-8");
    for (std::size_t i = 5; i < exact.size(); ++i) {
        EXPECT_LT(between(late[i], exact[i - 2]), 1e-9);
        EXPECT_LT(between(half[i], interpolate(exact[i - 1], exact[i], 0.5)), 1e-9);
        EXPECT_LT(between(frozen[i], i <= 8 ? exact[4] : exact[i]), 1e-12);
    }
}

TEST(ArmFaults, NoiseComesInBurstsAndAnOutlierOnce) {
    const std::vector<Pose> exact = some_motion(), noisy = with("arm-noise:20@1-"),
                            outlier = with("arm-outlier:80@3-7");
    for (std::size_t i = 0; i < exact.size(); ++i) {
        EXPECT_EQ(noisy[i].translation != exact[i].translation, (i >= 1 && i <= 5) || i == 11) << i;
        EXPECT_NEAR((outlier[i].translation - exact[i].translation).norm(), i == 3 ? 0.080 : 0.0, 1e-12) << i;
    }
    double squares = 0.0;
    for (std::uint64_t seed = 0; seed < 200; ++seed)
        squares += (with("arm-noise:20@1-", seed)[1].translation - exact[1].translation).squaredNorm();
    EXPECT_NEAR(std::sqrt(squares / 600.0), 0.020, 0.002);
}

TEST(ArmFaults, AHandEyeErrorIsThatOfTheArm) {
    const std::vector<Pose> exact = some_motion(), faulty = with("hand-eye:5@all");
    const Pose error = hand_eye_error({0.0, 0.0, 0.005, 0.0, 0.0}, 3);
    EXPECT_NEAR(error.translation.norm(), 0.005, 1e-12);
    for (std::size_t i = 0; i < exact.size(); ++i) EXPECT_LT(between(faulty[i], error * exact[i]), 1e-12);
}

TEST(ArmFaults, ActInTheirOrder) {
    const std::vector<Pose> exact = some_motion();
    const std::vector<Fault> faults{parse_fault("arm-units@all"), parse_fault("arm-inverted@all")};
    const std::vector<Pose> both = with_arm_faults(exact, faults, 1);
    EXPECT_LT(between(both[2], Pose{exact[2].rotation, 1e-3 * exact[2].translation}.inverse()), 1e-12);
}

TEST(WrittenCamera, IsOffByWhatTheFaultSays) {
    const PinholeCamera exact{64, 48, 60.0, 61.0, 31.5, 23.5};
    const auto written = [&](const char* fault, int frame = 3) {
        return written_camera(exact, {parse_fault(fault)}, frame);
    };
    EXPECT_EQ(written("principal-point:-4@all").cx, 27.5);
    EXPECT_EQ(written("principal-point:-4@all").cy, exact.cy);
    EXPECT_DOUBLE_EQ(written("focal:2@all").fx, 61.2);
    EXPECT_DOUBLE_EQ(written("focal:2@all").fy, 62.22);
    EXPECT_EQ(written("focal:2@4-").fx, exact.fx);
    // The image's middle stays its middle when its side is halved.
    const PinholeCamera half = written("half-intrinsics@all");
    EXPECT_EQ(half.cx, 15.5);
    EXPECT_EQ(half.cy, 11.5);
    EXPECT_EQ(half.fx, 30.0);
    EXPECT_EQ(half.width, 64);
}

TEST(PartMotion, APushIsOneStepAlongTheGround) {
    RandomStream random(9, 0, 0, RandomPurpose::kStart);
    const Pose scene_from_ground{random.rotation(), random.direction()};
    const std::vector<Fault> faults{parse_fault("pushed:20@3-5")};
    for (int frame = 0; frame < 3; ++frame) EXPECT_FALSE(part_motion(faults, scene_from_ground, 1, frame));
    for (int frame = 3; frame < 9; ++frame) {
        const Pose in_ground =
            scene_from_ground.inverse() * *part_motion(faults, scene_from_ground, 1, frame) * scene_from_ground;
        EXPECT_NEAR(in_ground.translation.norm(), 0.020, 1e-12);
        EXPECT_NEAR(in_ground.translation.z(), 0.0, 1e-12);
        EXPECT_NEAR(angle_between(in_ground.rotation, Eigen::Quaterniond::Identity()), 0.0, 1e-7);
    }
}

TEST(PartMotion, CarryingIsSteadyAndEndsWithItsFrames) {
    const std::vector<Fault> faults{parse_fault("carried@3-5")};
    const Pose ground = Pose::identity();
    EXPECT_FALSE(part_motion(faults, ground, 1, 2));
    for (int frame = 3; frame < 9; ++frame) {
        const int steps = std::min(frame, 5) - 2;
        const Pose moved = *part_motion(faults, ground, 1, frame);
        EXPECT_NEAR(moved.translation.norm(), 0.002 * steps, 1e-12);
        EXPECT_NEAR(angle_between(moved.rotation, Eigen::Quaterniond::Identity()), 0.5 * steps * M_PI / 180.0, 1e-9);
    }
}

}  // namespace
}  // namespace nearpose::simulate
