#include "apps/experiment/run_cells.hpp"

#include <gtest/gtest.h>

namespace nearpose::experiment {
namespace {

using evaluation::FrameErrors;
using evaluation::Shown;

// A run of a few small frames with these settings.
CellResult run_with(Settings settings) {
    const Settings small = {{"scenario", "baseline"}, {"part", "flange"}, {"frames", 9.0}, {"image_scale", 8.0},
                            {"particles", 10.0},      {"fps", 30.0},      {"burn_in", 0.0}};
    settings.insert(small.begin(), small.end());
    Workshop workshop(".");
    return run_recording({completed(TableKind::kRun, settings)}, 1, workshop, [] { return true; }).at(0);
}

std::string shown_in(const std::vector<FrameErrors>& frames) {
    std::string text;
    for (const FrameErrors& frame : frames)
        text += frame.shown == Shown::kPart ? 'p' : frame.shown == Shown::kNothing ? '-' : 'x';
    return text;
}

// What a frame shows does not depend on who looks at it: the cheapest filter does.
std::string shown_with(Settings settings) {
    settings.insert({{"method", "paper"}, {"particles", 1.0}});
    return shown_in(run_with(settings).frames);
}

TEST(RunCells, FramesSayWhatTheyShow) {
    EXPECT_EQ(shown_with({}), "ppppppppp");
    EXPECT_EQ(shown_with({{"look_away", 3.0}}), "ppp---ppp");
    EXPECT_EQ(shown_with({{"scene", "empty"}}), "---------");
    const std::string nonsense = shown_with({{"nonsense_frames", 2.0}});
    EXPECT_EQ(std::count(nonsense.begin(), nonsense.end(), 'x'), 2);
    EXPECT_EQ(nonsense.substr(0, 3), "ppp");
    const CellResult other = run_with({{"scene", "other"}});
    EXPECT_EQ(shown_in(other.frames), "---------");
    for (const FrameErrors& frame : other.frames) {
        EXPECT_TRUE(frame.verdict.has_value());
        EXPECT_FALSE(frame.visibility.has_value());
    }
}

TEST(RunCells, TheMoveIsToldOnceAlsoWhereItsFrameIsDropped) {
    for (const double dropped : {0.0, 0.5}) {
        int moves = 0;
        for (const FrameErrors& frame : run_with({{"object_moves", true}, {"dropped", dropped}}).frames) {
            moves += frame.part_moved ? 1 : 0;
            if (frame.part_moved) {
                EXPECT_GE(frame.frame_id, 4);
            }
        }
        EXPECT_EQ(moves, 1);
    }
}

TEST(RunCells, FramesSayWhetherTheFaultIsOver) {
    for (const char* fault : {"frozen@4-5", "dropped@4-5"}) {
        const CellResult run = run_with({{"fault", std::string(fault)}, {"method", "paper"}, {"particles", 1.0}});
        for (const FrameErrors& frame : run.frames) EXPECT_EQ(frame.after_fault, frame.frame_id > 5) << fault;
    }
}

TEST(RunCells, WrittenIntrinsicsAreBelievedAndTheTruthStays) {
    const CellResult right = run_with({}), wrong = run_with({{"fault", std::string("focal:50@all")}});
    ASSERT_EQ(right.frames.size(), wrong.frames.size());
    double apart_m = 0.0;
    for (std::size_t i = 0; i < right.frames.size(); ++i) {
        EXPECT_EQ(right.frames[i].visibility->distance_m, wrong.frames[i].visibility->distance_m);
        if (right.frames[i].errors && wrong.frames[i].errors)
            apart_m = std::max(apart_m, (right.frames[i].errors->translation_in_camera_m -
                                         wrong.frames[i].errors->translation_in_camera_m)
                                            .norm());
    }
    EXPECT_GT(apart_m, 0.001);
}

TEST(RunCells, AStartAtTheTruthIsNearItInEveryFrame) {
    // Without solving, the estimate is where it was started.
    const CellResult run = run_with({{"start", "truth"},
                                     {"gradient", false},
                                     {"sensor", "ideal"},
                                     {"object_moves", true},
                                     {"nonsense_frames", 1.0},
                                     {"particles", 50.0}});
    for (const FrameErrors& frame : run.frames) {
        ASSERT_TRUE(frame.errors.has_value());
        EXPECT_LT(frame.errors->translation_m, 0.02) << frame.frame_id;
        EXPECT_LT(frame.errors->rotation_rad, 0.1) << frame.frame_id;
    }
    EXPECT_EQ(run.figures.at("first_within_3"), 1.0);
}

TEST(RunCells, WrongCadIsBelievedAndTheTruthStays) {
    const CellResult right = run_with({}), wrong = run_with({{"cad", "wrong_unit"}});
    ASSERT_EQ(right.frames.size(), wrong.frames.size());
    for (std::size_t i = 0; i < right.frames.size(); ++i) {
        EXPECT_EQ(right.frames[i].visibility->distance_m, wrong.frames[i].visibility->distance_m);
        if (!wrong.frames[i].errors) continue;
        EXPECT_GT(wrong.frames[i].errors->translation_m, 0.02);  // as large, it must be farther away
    }
}

TEST(RunCells, WhatIsDrawnOfTheCadIsOfTheSeed) {
    Workshop workshop(".");
    Settings settings = completed(TableKind::kRun, {{"part", "flange"}, {"cad", "missing_boss"}});
    EXPECT_NE(workshop.views(settings, 1), workshop.views(settings, 1));  // not kept
    settings["cad"] = "mirrored";
    EXPECT_EQ(workshop.views(settings, 1), workshop.views(settings, 2));
    settings.erase("cad");
    EXPECT_EQ(workshop.views(settings, 1), workshop.views(settings, 2));
}

}  // namespace
}  // namespace nearpose::experiment
