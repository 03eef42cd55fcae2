// What estimate says about its verdicts when it has finished.
#include "apps/estimate/verdict_summary.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "apps/data_set/png_file.hpp"
#include "tests/apps/estimate/estimate_line.hpp"
#include "tests/apps/support/contains.hpp"

namespace nearpose::program_tests {
namespace {

using program::summary_lines;
using program::VerdictTally;

TEST(VerdictSummary, CountsVerdictsAndNamesTheThreeMostFrequentLacks) {
    VerdictTally tally{9, 2, 6, 1, {{"translation", 5, 0}, {"agreement", 3, 4}, {"seen", 1, 8}, {"support", 1, 8}}};
    const std::vector<std::string> lines = summary_lines(tally);
    ASSERT_EQ(lines.size(), 4U);
    EXPECT_EQ(lines[0], "verdicts of 9 frames: 2 accept, 6 continue, 1 lost");
    EXPECT_EQ(lines[1],
              "5 of 9 frames lack precision of the position (first: 0): " + program::advice_for("translation"));
    EXPECT_EQ(lines[3], "1 of 9 frames lacks sight of the part (first: 8): " + program::advice_for("seen"));
}

TEST(VerdictSummary, HasOneLineWhereAllIsAcceptedAndNoAdviceForWhatItDoesNotKnow) {
    EXPECT_EQ(summary_lines({1, 1, 0, 0, {}}),
              std::vector<std::string>{"verdicts of 1 frame: 1 accept, 0 continue, 0 lost"});
    EXPECT_EQ(summary_lines({1, 0, 1, 0, {{"colour", 1, 0}}}).at(1), "1 of 1 frame lacks colour (first: 0)");
}

TEST(VerdictSummary, KeepsTheLastSentenceOfWhatImageAndArmSayAgainstEachOther) {
    program::ArmSentences sentences;
    program::gather(sentences, 4, {{Requirement::kNewImage, 1.0, 0.0, "4.0 mm"}, {Requirement::kSeen, 0.0, 1.0, {}}});
    program::gather(sentences, 5, {{Requirement::kNewImage, 2.0, 0.0, "8.0 mm"}});
    ASSERT_EQ(sentences.size(), 1U);
    EXPECT_EQ(sentences.at(Requirement::kNewImage),
              "frame 5: the image has not changed for 2 frames while the camera moved by 8.0 mm");
}

// The summary agrees with the log: of a part that is precise enough in no frame, and hidden in one of three.
TEST(VerdictSummary, OfARunIsThatOfItsLog) {
    const TinyScene scene(3);
    data_set::write_mask_png(scene.scene() / "mask_visib/000001_000000.png",
                             {160, 120, std::vector<std::uint8_t>(160 * 120, 0)});
    const std::string log = scene.file("log.jsonl").string();
    const Outcome outcome = run_nearpose(estimate(scene, "--tolerance-mm 0.001 --log " + log));
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    std::map<std::string, int> verdicts, lacks;
    const std::vector<std::string> lines = lines_of(read_text(log));
    for (std::size_t i = 1; i < lines.size(); ++i) {
        const nlohmann::json frame = nlohmann::json::parse(lines[i]);
        ++verdicts[frame["verdict"]];
        for (const nlohmann::json& lack : frame["missing"]) ++lacks[lack["requirement"]];
    }
    EXPECT_EQ(verdicts["accept"], 0);
    EXPECT_EQ(verdicts["lost"], 1);
    EXPECT_TRUE(contains(outcome.err, "verdicts of 3 frames: 0 accept, 2 continue, 1 lost\n")) << outcome.err;
    EXPECT_EQ(lacks["translation"], 2);
    EXPECT_TRUE(contains(outcome.err, "2 of 3 frames lack precision of the position (first: 0): ")) << outcome.err;
    EXPECT_TRUE(contains(outcome.err, "1 of 3 frames lacks sight of the part (first: 1): ")) << outcome.err;
}

TEST(VerdictSummary, IsNotPrintedWhereNoneWasAsked) {
    const TinyScene scene(1);
    const std::string line = estimate(scene, "--tolerance-mm 0.001");
    EXPECT_TRUE(contains(run_nearpose(line).err, "precision of the position"));
    EXPECT_EQ(run_nearpose(line + " --quiet").err, "");
}

}  // namespace
}  // namespace nearpose::program_tests
