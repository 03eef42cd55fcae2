#include "apps/scenes/fault.hpp"

#include <gtest/gtest.h>

#include <set>

#include "tests/apps/support/contains.hpp"

namespace nearpose::simulate {
namespace {

std::string refusal(const std::string& text) {
    try {
        parse_fault(text);
    } catch (const std::invalid_argument& error) {
        return error.what();
    }
    return "";
}

std::string refusal(const Fault& fault, const FaultSetting& setting) {
    try {
        validate({fault}, setting);
    } catch (const std::invalid_argument& error) {
        return error.what();
    }
    return "";
}

TEST(Fault, RulesAreInTheOrderOfTheirKindsAndHaveNamesOfTheirOwn) {
    std::set<std::string> names;
    for (std::size_t i = 0; i < fault_rules().size(); ++i) {
        EXPECT_EQ(static_cast<std::size_t>(fault_rules()[i].kind), i);
        EXPECT_TRUE(names.insert(fault_rules()[i].name).second);
    }
    EXPECT_EQ(static_cast<std::size_t>(FaultKind::kCarried) + 1, fault_rules().size());
}

TEST(Fault, TextGivesBackWhatWasRead) {
    for (const char* text : {"frozen@all", "rotated:270@3", "shift:-4@0-7", "temporal-filter:0.4@10-", "late@5-5"}) {
        const Fault fault = parse_fault(text);
        const Fault again = parse_fault(text_of(fault));
        EXPECT_EQ(again.kind, fault.kind) << text;
        EXPECT_EQ(again.value, fault.value);
        EXPECT_EQ(again.first, fault.first);
        EXPECT_EQ(again.last, fault.last);
    }
    const Fault some = parse_fault("depth-scale:-2.5@10-39");
    EXPECT_EQ(some.kind, FaultKind::kDepthScale);
    EXPECT_EQ(some.value, -2.5);
    for (int frame = 0; frame < 60; ++frame) EXPECT_EQ(some.is_in(frame), frame >= 10 && frame <= 39);
}

TEST(Fault, BadTextIsToldInOneLine) {
    const std::string unknown = refusal("frozne@all");
    for (const FaultRule& rule : fault_rules()) {
        EXPECT_TRUE(contains(unknown, rule.name));
        EXPECT_TRUE(contains(unknown, rule.meaning)) << rule.name;
    }
    EXPECT_TRUE(contains(unknown, "did you mean frozen?"));
    struct Case {
        const char *text, *told;
    };
    for (const Case& bad :
         {Case{"frozen", "@10-39"}, Case{"frozen@", "@10-39"}, Case{"frozen@-4", "@10-39"},
          Case{"frozen@1-x", "@10-39"}, Case{"frozen@9-3", "before it begins"}, Case{"frozen:3@all", "no value"},
          Case{"shift@all", "needs a value: shift:PIXELS"}, Case{"shift:1.5@all", "whole number in -1000..1000"},
          Case{"shift:@all", "-1000..1000"}, Case{"rotated:100@all", "90, 180 or 270"}, Case{"holes:2@all", "0..0.9"},
          Case{"holes:nan@all", "0..0.9"}}) {
        const std::string told = refusal(bad.text);
        EXPECT_TRUE(contains(told, bad.told)) << bad.text << ": " << told;
        EXPECT_EQ(told.find('\n'), std::string::npos);
    }
}

TEST(Fault, WhatARecordingCannotHaveIsRefused) {
    const FaultSetting wide{{64, 48, 60.0, 60.0, 31.5, 23.5}, Scenario::kPiston, 40, {}};
    FaultSetting square = wide, belt = wide, empty = wide, moved = wide;
    square.camera.width = 48;
    belt.scenario = Scenario::kConveyor;
    empty.disturbances.scene = SceneContent::kEmpty;
    moved.disturbances.object_moves = true;
    for (const char* good : {"frozen@0-39", "frozen@39-", "rotated:180@all", "pushed:5@1-", "carried@all"})
        EXPECT_EQ(refusal(parse_fault(good), wide), "") << good;
    EXPECT_EQ(refusal(parse_fault("rotated:90@all"), square), "");
    EXPECT_TRUE(contains(refusal(parse_fault("rotated:90@all"), wide), "64 x 48"));
    for (const char* beyond : {"frozen@40-", "frozen@10-40"})
        EXPECT_TRUE(contains(refusal(parse_fault(beyond), wide), "0 to 39")) << beyond;
    EXPECT_TRUE(contains(refusal(parse_fault("pushed:5@all"), wide), "begin at 1"));
    EXPECT_TRUE(contains(refusal(parse_fault("pushed:5@3"), belt), "stands still"));
    EXPECT_TRUE(contains(refusal(parse_fault("carried@3-"), empty), "scene"));
    EXPECT_TRUE(contains(refusal(parse_fault("carried@3-"), moved), "object_moves"));
}

}  // namespace
}  // namespace nearpose::simulate
