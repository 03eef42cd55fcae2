#include "apps/runs/verdict_tally.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace nearpose::program {
namespace {

TEST(VerdictTally, CountsVerdictsAndLacksAndNamesTheFirstFrame) {
    const VerdictTally tally = tally_of({{4, Verdict::kAccept, {}},
                                         {5, Verdict::kLost, {"seen"}},
                                         {7, Verdict::kContinue, {"translation", "rotation"}},
                                         {8, Verdict::kContinue, {"rotation"}},
                                         {9, Verdict::kContinue, {"rotation", "translation"}}});
    EXPECT_EQ(tally.frames, 5);
    EXPECT_EQ(tally.accepts, 1);
    EXPECT_EQ(tally.continues, 3);
    EXPECT_EQ(tally.lost, 1);
    ASSERT_EQ(tally.lacks.size(), 3U);
    EXPECT_EQ(tally.lacks[0].requirement, "rotation");
    EXPECT_EQ(tally.lacks[0].frames, 3);
    EXPECT_EQ(tally.lacks[0].first_frame, 7);
    EXPECT_EQ(tally.lacks[1].requirement, "translation");
    EXPECT_EQ(tally.lacks[1].frames, 2);
    EXPECT_EQ(tally.lacks[2].first_frame, 5);
}

TEST(VerdictTally, OfEquallyFrequentLacksTheEarlierComesFirst) {
    const VerdictTally tally = tally_of({{0, Verdict::kContinue, {"support"}}, {1, Verdict::kContinue, {"agreement"}}});
    ASSERT_EQ(tally.lacks.size(), 2U);
    EXPECT_EQ(tally.lacks[0].requirement, "support");
    EXPECT_TRUE(tally_of({}).lacks.empty());
}

// A requirement that is added to the library needs words here.
TEST(VerdictTally, EveryRequirementHasItsOwnTitleAndAnAdvice) {
    std::vector<std::string> titles;
    for (int i = 0; *to_string(static_cast<Requirement>(i)) != '\0'; ++i) {
        const std::string name = to_string(static_cast<Requirement>(i));
        EXPECT_NE(title_of(name), name);
        EXPECT_FALSE(title_of(name).empty()) << name;
        EXPECT_FALSE(advice_for(name).empty()) << name;
        EXPECT_EQ(std::count(titles.begin(), titles.end(), title_of(name)), 0) << name;
        titles.push_back(title_of(name));
    }
    EXPECT_EQ(titles.size(), 14U);
}

TEST(VerdictTally, AWordOfANewerProgramStandsForItself) {
    EXPECT_EQ(title_of("colour"), "colour");
    EXPECT_EQ(advice_for("colour"), "");
}

TEST(LoggedVerdict, ReadsEveryVerdictAndRefusesOthers) {
    for (const Verdict verdict : {Verdict::kAccept, Verdict::kContinue, Verdict::kLost}) {
        const auto file = data_set::JsonFile::from_text("\"" + std::string(to_string(verdict)) + "\"", "log");
        EXPECT_EQ(logged_verdict(file.root()), verdict);
    }
    const auto file = data_set::JsonFile::from_text("{\"verdict\":\"perhaps\"}", "log");
    EXPECT_THROW(logged_verdict(file.root().at("verdict")), std::runtime_error);
}

}  // namespace
}  // namespace nearpose::program
