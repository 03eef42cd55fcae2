// What evaluate makes of the verdicts in a log.
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>

#include "apps/error_measures/frame_errors.hpp"
#include "tests/apps/evaluate/some_results.hpp"

namespace nearpose::program_tests {
namespace {

// What of a log frames from before there were verdicts did not have.
std::string without_verdict(std::string line) {
    const std::size_t begin = line.find("\"verdict\":"), end = line.find(',', begin);
    return line.erase(begin, end + 1 - begin);
}

// The first line of a log: what every log has, and more.
std::string first_line_with(const std::string& more) {
    return R"({"format":1,"content":"nearpose estimate")" + more + "}";
}

class EvaluateVerdicts : public testing::Test {
  protected:
    EvaluateVerdicts() : scene_(4) {
        write_results(scene_, some_rows(scene_, 0.003));
        write_log(scene_, some_rows(scene_, 0.003), first_line_with(""));
    }

    std::string call(const std::string& more) const {
        return evaluate(scene_) + "--log " + scene_.file("log.jsonl").string() + " " + more;
    }
    nlohmann::json verdicts(const std::string& more = "") const {
        return nlohmann::json::parse(run_nearpose(call("--json - " + more)).out).at("verdicts");
    }

    TinyScene scene_;
};

TEST_F(EvaluateVerdicts, AreCountedAndComparedWithTheTruth) {
    const Outcome outcome = run_nearpose(call("--out " + scene_.file("table.csv").string()));
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_TRUE(
        contains(outcome.out, "verdicts of 4 frames: 1 accept, 1 continue, 2 lost; tolerance 2 mm and 1 deg\n"));
    EXPECT_TRUE(contains(outcome.out,
                         "accepted but beyond the tolerance: 1 of 1 (95 % interval 20.7 % to 100.0 %); "
                         "lost though within it: 0 of 2\n"))
        << outcome.out;
    EXPECT_TRUE(contains(outcome.err, "log.jsonl: does not state the verdicts' tolerance")) << outcome.err;
    const std::vector<std::string> table = lines_of(read_text(scene_.file("table.csv")));
    ASSERT_EQ(table.size(), 5U);
    EXPECT_TRUE(table[0].ends_with(",verdict,shown,part_moved,verdict_error")) << table[0];
    EXPECT_TRUE(table[1].ends_with(",accept,part,0,false_accept")) << table[1];
    EXPECT_TRUE(table[2].ends_with(",lost,part,0,")) << table[2];
    const auto frames = evaluation::read_table(scene_.file("table.csv"));
    EXPECT_EQ(frames[1].verdict, Verdict::kLost);  // without a pose
    EXPECT_EQ(frames[2].verdict, Verdict::kContinue);

    const nlohmann::json counts = verdicts();
    const std::map<std::string, int> expected = {{"frames", 4}, {"accept", 1},        {"continue", 1},
                                                 {"lost", 2},   {"false_accepts", 1}, {"missed", 0}};
    for (const auto& [key, value] : expected) EXPECT_EQ(counts.at(key), value) << key;
    EXPECT_TRUE(counts.at("first_right_accept_frame").is_null());
}

TEST_F(EvaluateVerdicts, AreJudgedByTheToleranceOfTheOptionsOrTheLog) {
    const Outcome asked = run_nearpose(call("--tolerance-mm 4 --tolerance-deg 2"));
    EXPECT_TRUE(contains(asked.out, "tolerance 4 mm and 2 deg\n")) << asked.out;
    EXPECT_TRUE(contains(asked.out, "accepted but beyond the tolerance: 0 of 1")) << asked.out;
    EXPECT_TRUE(contains(asked.out, "lost though within it: 1 of 2\n")) << asked.out;
    EXPECT_FALSE(contains(asked.err, "tolerance")) << asked.err;
    EXPECT_EQ(verdicts("--tolerance-mm 4").at("first_right_accept_frame"), 0);

    write_log(scene_, some_rows(scene_, 0.003), first_line_with(R"(,"tolerance_m":0.005,"tolerance_rad":0.02)"));
    EXPECT_FALSE(contains(run_nearpose(call("")).err, "tolerance"));
    EXPECT_NEAR(verdicts().at("tolerance_mm").get<double>(), 5.0, 1e-12);
    EXPECT_NEAR(verdicts("--tolerance-deg 3").at("tolerance_deg").get<double>(), 3.0, 1e-12);
    EXPECT_NEAR(verdicts("--tolerance-deg 3").at("tolerance_mm").get<double>(), 5.0, 1e-12);
    EXPECT_EQ(verdicts().at("missed"), 1);
    write_log(scene_, some_rows(scene_, 0.003), first_line_with(R"(,"tolerance_m":-0.01,"tolerance_rad":0.02)"));
    const Outcome negative = run_nearpose(call(""));
    EXPECT_EQ(negative.exit_code, 1);
    EXPECT_TRUE(contains(negative.err, "log.jsonl: line 1") && contains(negative.err, "tolerance_m")) << negative.err;
}

TEST_F(EvaluateVerdicts, ThatAreUnknownAreRefused) {
    std::string log = read_text(scene_.file("log.jsonl"));
    log.replace(log.find("\"accept\""), 8, "\"maybe\"");
    write_text(scene_.file("log.jsonl"), log);
    const Outcome outcome = run_nearpose(call(""));
    EXPECT_EQ(outcome.exit_code, 1);
    for (const char* part : {"log.jsonl: line 2", "maybe", "accept, continue, lost"}) {
        EXPECT_TRUE(contains(outcome.err, part)) << outcome.err;
    }
}

// Logs from before there were verdicts.
TEST_F(EvaluateVerdicts, NeedNotBeThere) {
    std::string log;
    for (const std::string& line : lines_of(read_text(scene_.file("log.jsonl")))) {
        log += (contains(line, "\"verdict\":") ? without_verdict(line) : line) + "\n";
    }
    write_text(scene_.file("log.jsonl"), log);
    const Outcome outcome = run_nearpose(call("--out " + scene_.file("table.csv").string()));
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_TRUE(contains(outcome.out, "90 % region")) << outcome.out;  // the covariances hold all the same
    EXPECT_FALSE(contains(outcome.out, "verdict") || contains(outcome.err, "tolerance")) << outcome.out;
    EXPECT_TRUE(verdicts().is_null());
    // The same columns as without a log at all.
    const std::string header = lines_of(read_text(scene_.file("table.csv")))[0];
    EXPECT_EQ(header, lines_of(run_nearpose(evaluate(scene_) + "--out -").out)[0]);
    EXPECT_TRUE(header.ends_with(",part_moved")) << header;
}

}  // namespace
}  // namespace nearpose::program_tests
