// A set-up that lies is not acted on: approaches to the engine block with faults put into the recording.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/runs/estimator_setup.hpp"
#include "apps/scenes/parts.hpp"
#include "apps/scenes/recording.hpp"
#include "core/estimator.hpp"

namespace nearpose {
namespace {

constexpr int kFrames = 30;

struct JudgedFrame {
    Verdict verdict = Verdict::kLost;
    bool right = false;  // within the tolerance of the truth
    bool repeated = false;
};

bool is_right(const Pose& camera_from_object, const Pose& truth, const Eigen::Vector3d& centre_in_object) {
    const Tolerance tolerance;
    return (camera_from_object * centre_in_object - truth * centre_in_object).norm() < tolerance.translation_m &&
           angle_between(camera_from_object.rotation, truth.rotation) < tolerance.rotation_rad;
}

std::vector<JudgedFrame> run_with(const std::vector<std::string>& faults) {
    const Mesh mesh = simulate::embedded_part("engine_block").mesh;
    simulate::RecordingOptions options;
    options.num_frames = kFrames;
    options.seed = 7;
    options.camera = {320, 240, 300.0, 300.0, 159.5, 119.5};
    for (const std::string& fault : faults) options.faults.push_back(simulate::parse_fault(fault));
    const simulate::Recording recording(mesh, simulate::engine_block_part(extent_of(mesh)), options);
    const program::EstimatorSetup setup;
    PoseEstimator estimator = program::make_estimator(setup, program::make_view_generator(setup, mesh));
    std::vector<JudgedFrame> judged;
    std::optional<Pose> camera_from_world_before;
    for (int k = 0; k < recording.num_frames(); ++k) {
        const simulate::SimulatedFrame frame = recording.frame(k);
        std::optional<Pose> now_from_before;
        if (camera_from_world_before) now_from_before = frame.camera_from_world * camera_from_world_before->inverse();
        camera_from_world_before = frame.camera_from_world;
        const UpdateResult result =
            estimator.update(make_observation(frame.depth, frame.camera, frame.given_mask), now_from_before);
        judged.push_back(
            {result.verdict,
             is_right(result.camera_from_object, frame.camera_from_object, recording.extent().centre_in_object()),
             !result.missing.empty() && result.missing[0].requirement == Requirement::kNewImage});
    }
    return judged;
}

int count(const std::vector<JudgedFrame>& frames, int first, int last,
          const std::function<bool(const JudgedFrame&)>& holds) {
    return static_cast<int>(std::count_if(frames.begin() + first, frames.begin() + last + 1, holds));
}

bool accepted(const JudgedFrame& frame) {
    return frame.verdict == Verdict::kAccept;
}

bool accepted_wrong(const JudgedFrame& frame) {
    return accepted(frame) && !frame.right;
}

TEST(ArmFaults, AGoodSetUpIsAcceptedAndNeverWrong) {
    const std::vector<JudgedFrame> frames = run_with({});
    EXPECT_GE(count(frames, 10, kFrames - 1, accepted), 10);
    EXPECT_EQ(count(frames, 0, kFrames - 1, accepted_wrong), 0);
}

TEST(ArmFaults, ACameraThatHangsIsNotedAtOnceAndItsEndToo) {
    const std::vector<JudgedFrame> frames = run_with({"frozen@12-20"});
    EXPECT_EQ(count(frames, 12, 20, [](const JudgedFrame& frame) { return frame.repeated; }), 9);
    EXPECT_EQ(count(frames, 12, 20, accepted), 0);
    EXPECT_GE(count(frames, 21, 25, [](const JudgedFrame& frame) { return accepted(frame) && frame.right; }), 1);
    EXPECT_EQ(count(frames, 0, kFrames - 1, accepted_wrong), 0);
}

TEST(ArmFaults, ASetUpThatContradictsTheArmIsNotAcceptedForLong) {
    for (const char* fault : {"rotated:180@all", "mirrored@all", "principal-point:20@all", "focal:3@all"}) {
        const std::vector<JudgedFrame> frames = run_with({fault});
        EXPECT_EQ(count(frames, 10, kFrames - 1, accepted_wrong), 0) << fault;
    }
}

TEST(ArmFaults, APartThatIsPushedIsFollowedAndAcceptedAgain) {
    const std::vector<JudgedFrame> frames = run_with({"pushed:20@15"});
    EXPECT_EQ(count(frames, 15, kFrames - 1, [](const JudgedFrame& frame) { return !frame.right; }), 0);
    EXPECT_GE(count(frames, 20, kFrames - 1, accepted), 8);
}

}  // namespace
}  // namespace nearpose
