#include "apps/error_measures/verdict_counts.hpp"

#include <gtest/gtest.h>

namespace nearpose::evaluation {
namespace {

constexpr Tolerance kTolerance{0.002, 0.02};

FrameErrors frame_with(Verdict verdict, double translation_m, double rotation_rad = 0.0) {
    FrameErrors frame;
    frame.verdict = verdict;
    frame.errors.emplace();
    frame.errors->translation_m = translation_m;
    frame.errors->rotation_rad = rotation_rad;
    return frame;
}

TEST(FalseAccept, IsAWrongPoseOrAPartThatIsNotThere) {
    EXPECT_FALSE(is_false_accept(frame_with(Verdict::kAccept, 0.0019, 0.019), kTolerance));
    EXPECT_TRUE(is_false_accept(frame_with(Verdict::kAccept, 0.0021), kTolerance));
    EXPECT_TRUE(is_false_accept(frame_with(Verdict::kAccept, 0.0, 0.021), kTolerance));
    EXPECT_FALSE(is_false_accept(frame_with(Verdict::kContinue, 1.0), kTolerance));
    EXPECT_FALSE(is_false_accept(frame_with(Verdict::kLost, 1.0), kTolerance));
    for (const Shown shown : {Shown::kNothing, Shown::kNonsense}) {
        FrameErrors frame = frame_with(Verdict::kAccept, 0.0);
        frame.shown = shown;
        EXPECT_TRUE(is_false_accept(frame, kTolerance));
    }
    FrameErrors without_pose;
    without_pose.verdict = Verdict::kAccept;
    EXPECT_TRUE(is_false_accept(without_pose, kTolerance));
    EXPECT_FALSE(is_false_accept({}, kTolerance));
}

TEST(Missed, IsARightPoseThatIsGivenUp) {
    EXPECT_TRUE(is_missed(frame_with(Verdict::kLost, 0.0019, 0.019), kTolerance));
    EXPECT_FALSE(is_missed(frame_with(Verdict::kLost, 0.0021), kTolerance));
    EXPECT_FALSE(is_missed(frame_with(Verdict::kLost, 0.0, 0.021), kTolerance));
    EXPECT_FALSE(is_missed(frame_with(Verdict::kContinue, 0.0), kTolerance));
    EXPECT_FALSE(is_missed(frame_with(Verdict::kAccept, 0.0), kTolerance));
    FrameErrors elsewhere = frame_with(Verdict::kLost, 0.0);
    elsewhere.shown = Shown::kNothing;
    EXPECT_FALSE(is_missed(elsewhere, kTolerance));
    FrameErrors without_pose;
    without_pose.verdict = Verdict::kLost;
    EXPECT_FALSE(is_missed(without_pose, kTolerance));
}

TEST(VerdictCounts, AreOfAllFrames) {
    FrameErrors empty = frame_with(Verdict::kAccept, 0.0);
    empty.shown = Shown::kNothing;
    const VerdictCounts counts =
        count_verdicts({frame_with(Verdict::kContinue, 0.0), frame_with(Verdict::kAccept, 0.01), empty,
                        frame_with(Verdict::kAccept, 0.001), frame_with(Verdict::kLost, 0.5),
                        frame_with(Verdict::kLost, 0.001), FrameErrors{}},
                       kTolerance);
    EXPECT_EQ(counts.frames, 6);  // the last has no verdict
    EXPECT_EQ(counts.accepts + counts.continues + counts.lost, counts.frames);
    EXPECT_EQ(counts.continues, 1);
    EXPECT_EQ(counts.missed, 1);
    EXPECT_EQ(counts.accepts, 3);
    EXPECT_EQ(counts.false_accepts, 2);
    EXPECT_EQ(counts.lost, 2);
    EXPECT_EQ(counts.first_right_accept, 3);
    EXPECT_EQ(counts.well_within, 3);
    EXPECT_EQ(counts.well_within_accepts, 1);
    EXPECT_EQ(count_verdicts({frame_with(Verdict::kAccept, 0.0011)}, kTolerance).well_within, 0);
    EXPECT_EQ(count_verdicts({frame_with(Verdict::kAccept, 0.0, 0.011)}, kTolerance).well_within, 0);
    EXPECT_EQ(count_verdicts({FrameErrors{}}, kTolerance).frames, 0);  // without a verdict
    EXPECT_EQ(count_verdicts({empty}, kTolerance).first_right_accept, std::nullopt);
}

TEST(VerdictCounts, RecoveryIsARightAcceptAfterTheFault) {
    std::vector<FrameErrors> frames = {frame_with(Verdict::kAccept, 0.0), frame_with(Verdict::kAccept, 0.0),
                                       frame_with(Verdict::kLost, 0.0), frame_with(Verdict::kAccept, 0.01),
                                       frame_with(Verdict::kAccept, 0.001)};
    EXPECT_EQ(count_verdicts(frames, kTolerance).frames_to_recover, std::nullopt);
    for (std::size_t i = 2; i < frames.size(); ++i) frames[i].after_fault = true;
    EXPECT_EQ(count_verdicts(frames, kTolerance).frames_to_recover, 3);
    frames.pop_back();
    EXPECT_EQ(count_verdicts(frames, kTolerance).frames_to_recover, std::nullopt);
}

}  // namespace
}  // namespace nearpose::evaluation
