#include "apps/error_measures/interruptions.hpp"

#include <gtest/gtest.h>

#include <string>

#include "apps/error_measures/run_summary.hpp"

namespace nearpose::evaluation {
namespace {

// A letter a frame: g the pose is good, b it is bad, . there is none; G, B the same where the part lies elsewhere from;
// 0, 1 the part is not in view, and the pose is bad or good; x the image is nonsense, the pose bad.
std::vector<FrameErrors> frames_of(const std::string& letters) {
    std::vector<FrameErrors> frames;
    for (const char letter : letters) {
        FrameErrors& frame = frames.emplace_back();
        frame.part_moved = letter == 'G' || letter == 'B';
        if (letter == '0' || letter == '1') frame.shown = Shown::kNothing;
        if (letter == 'x') frame.shown = Shown::kNonsense;
        if (letter == '.') continue;
        const bool good = letter == 'g' || letter == 'G' || letter == '1';
        frame.errors.emplace();
        frame.errors->translation_m = good ? 0.001 : 0.1;
    }
    return frames;
}

RunSummary summary_of(const std::string& letters, int burn_in = 0) {
    return summarise(frames_of(letters), 0.2, {burn_in, {}, {}, {}});
}

std::string excused(const std::string& letters) {
    std::string text;
    for (const bool is : excused_frames(frames_of(letters))) text += is ? 'e' : '-';
    return text;
}

TEST(Interruptions, ExcuseThemselvesAndTheThreeFramesAfter) {
    EXPECT_EQ(excused("gbgbgb"), "------");
    EXPECT_EQ(excused("gg00ggggg"), "--eeeee--");
    EXPECT_EQ(excused("gxgggggg"), "-eeee---");
    EXPECT_EQ(excused("ggBbbbb"), "--eee--");
    EXPECT_EQ(excused("g0Bbbbb"), "-eeee--");
    EXPECT_EQ(excused("gxgxgggg"), "-eeeeee-");
    EXPECT_EQ(excused("000"), "eee");
}

TEST(Interruptions, TheReturnIsWhereThePartIsBackOrElsewhere) {
    EXPECT_EQ(return_index(frames_of("gg00gg")), 4);
    EXPECT_EQ(return_index(frames_of("gg00Bg")), 4);
    EXPECT_EQ(return_index(frames_of("ggBg")), 2);
    EXPECT_EQ(return_index(frames_of("g0xg")), 2);  // the camera looks again, and sees nonsense first
    EXPECT_EQ(return_index(frames_of("gxxg")), std::nullopt);
    EXPECT_EQ(return_index(frames_of("000gg")), std::nullopt);  // it was never there before
    EXPECT_EQ(return_index(frames_of("gg000")), std::nullopt);
}

TEST(Interruptions, FaultsEndWithTheFirstFrameAfterThem) {
    std::vector<FrameErrors> frames(5);
    EXPECT_EQ(end_of_fault(frames), std::nullopt);
    frames[3].after_fault = frames[4].after_fault = true;
    EXPECT_EQ(end_of_fault(frames), 3);
    EXPECT_EQ(end_of_fault({}), std::nullopt);
}

TEST(Interruptions, FramesToRefindCountFromTheReturn) {
    EXPECT_EQ(summary_of("gg00gg").frames_to_refind, 1);
    EXPECT_EQ(summary_of("ggBbbgg").frames_to_refind, 4);
    EXPECT_EQ(summary_of("g0xg").frames_to_refind, 2);
    EXPECT_EQ(summary_of("ggBbbb").frames_to_refind, std::nullopt);
    EXPECT_EQ(summary_of("bbbgg").frames_to_refind, std::nullopt);
}

TEST(Interruptions, WhatIsFoundAgainInTimeIsHeld) {
    for (const char* held : {"ggggg", "gg000bbbgg", "gg0Bbbgg", "ggxggg", "ggxbbbg", "gg11bg"}) {
        const RunSummary summary = summary_of(held);
        EXPECT_TRUE(summary.held) << held;
        EXPECT_TRUE(summary.coarse.stays()) << held;
        EXPECT_EQ(summary.frames_lost, 0) << held;
    }
    for (const char* lost : {"ggbgg", "gg0bbbbg", "ggBbbbg", "ggxggbbg", "gg...", "0000"})
        EXPECT_FALSE(summary_of(lost).held) << lost;
    EXPECT_EQ(summary_of("gg0bbbbg").frames_lost, 1);  // the fourth
    EXPECT_EQ(summary_of("gg0bbbbg").frames_after_arrival, 3);
    // What is excused about the burn-in's end is not asked for either.
    EXPECT_TRUE(summary_of("bbbxggg", 3).held);
    EXPECT_FALSE(summary_of("bbbbxggg", 3).held);
}

TEST(Interruptions, FramesWithoutThePartAreNoErrorsAndNoArrival) {
    const RunSummary summary = summary_of("bg1x0g");
    EXPECT_EQ(summary.frames, 6);
    EXPECT_EQ(summary.frames_shown, 3);
    EXPECT_EQ(summary.translation_mm.count, 3U);
    EXPECT_DOUBLE_EQ(summary.translation_mm.mean, 34.0);
    EXPECT_EQ(summary_of("1b").coarse.first_index, std::nullopt);
    EXPECT_EQ(summary_of("111").translation_mm.count, 0U);
}

}  // namespace
}  // namespace nearpose::evaluation
