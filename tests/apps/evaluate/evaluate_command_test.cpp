// evaluate, run as a user would.
#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <nlohmann/json.hpp>

#include "apps/data_set/bop_models.hpp"
#include "apps/data_set/png_file.hpp"
#include "apps/data_set/result_csv.hpp"
#include "apps/data_set/trajectory_tum.hpp"
#include "apps/error_measures/frame_errors.hpp"
#include "apps/estimate/frame_log.hpp"
#include "tests/apps/support/tiny_scene.hpp"

namespace nearpose::program_tests {
namespace {

bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

std::string evaluate(const TinyScene& scene) {
    return "evaluate --scene " + scene.scene().string() + " --models " + scene.models().string() +
           " --object 1 --burn-in 0 --results " + scene.file("poses.csv").string() + " ";
}

Pose moved(Pose pose, double offset_m) {
    pose.translation.x() += offset_m;
    return pose;
}

// The true poses, each moved by `offset` along the camera's x axis; frame 1 is left out.
std::vector<data_set::PoseRow> some_rows(const TinyScene& scene, double offset_m, int scene_id = 7) {
    std::vector<data_set::PoseRow> rows;
    for (const int frame : {0, 2, 3}) {
        rows.push_back(
            {scene_id, frame, 1, 0.9, moved(scene.truth()[static_cast<std::size_t>(frame)], offset_m), 0.01});
    }
    return rows;
}

void write_results(const TinyScene& scene, const std::vector<data_set::PoseRow>& rows) {
    data_set::PoseCsvWriter writer(scene.file("poses.csv"));
    for (const data_set::PoseRow& row : rows) writer.append(row);
    writer.close();
}

// What of a log frames from before there were verdicts did not have.
std::string without_verdict(std::string line) {
    const std::size_t begin = line.find("\"verdict\":"), end = line.find(',', begin);
    return line.erase(begin, end + 1 - begin);
}

// Accepts frame 0, goes on at frame 2, gives up frame 3; frame 1 has no pose.
Verdict verdict_of_frame(int frame) {
    return frame == 0 ? Verdict::kAccept : frame == 2 ? Verdict::kContinue : Verdict::kLost;
}

// Of the same rows, with a standard deviation of 1 mm and 0.01 rad along all axes; frame 2 is predicted.
void write_log(const TinyScene& scene, const std::vector<data_set::PoseRow>& rows,
               const std::string& first_line = program::first_log_line({})) {
    std::string log = first_line + "\n";
    for (const data_set::PoseRow& row : rows) {
        UpdateResult result;
        result.status = row.image_id == 2 ? UpdateStatus::kPredicted : UpdateStatus::kEstimated;
        result.camera_from_object = row.camera_from_object;
        result.verdict = verdict_of_frame(row.image_id);
        result.covariance.diagonal() << 1e-4, 1e-4, 1e-4, 1e-6, 1e-6, 1e-6;
        log += program::frame_log_line({row.image_id, 0.0, 0.01, ""}, result) + "\n";
    }
    UpdateResult nothing;
    nothing.verdict = verdict_of_frame(1);
    log += program::frame_log_line({1, 0.0, 0.01, ""}, nothing) + "\n";
    write_text(scene.file("log.jsonl"), log);
}

TEST(Evaluate, MeasuresWhatWasPutIn) {
    const TinyScene scene(4);
    write_results(scene, some_rows(scene, 0.002));
    const Outcome outcome = run_nearpose(evaluate(scene) + "--out " + scene.file("new/table.csv").string() +
                                         " --plot " + scene.file("error.png").string());
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_TRUE(contains(outcome.out, "4 frames, 1 without a pose, 0 predicted")) << outcome.out;
    const std::string twos = "     2.000     0.000     2.000     2.000     2.000\n";
    for (const char* name :
         {"translation [mm]    ", "  along x [mm]      ", "ADD [mm]            ", "MSSD [mm]           "}) {
        EXPECT_TRUE(contains(outcome.out, name + std::string(4, ' ') + twos)) << name << outcome.out;
    }
    EXPECT_TRUE(contains(outcome.out, "ADD 73.5 %")) << outcome.out;  // 3 of 4 frames, 98 % each
    EXPECT_TRUE(contains(outcome.out, "within 10 mm and 5 deg: first in frame 0, for good from frame 2 on"));
    EXPECT_TRUE(contains(outcome.out, "within 2 mm and 1 deg: ")) << outcome.out;
    EXPECT_TRUE(contains(outcome.out, "lost after the first arrival: 1 of 3 frames")) << outcome.out;
    EXPECT_FALSE(contains(outcome.out, "90 % region"));
    EXPECT_EQ(data_set::read_png_size(scene.file("error.png")).width, 1000);

    const std::vector<evaluation::FrameErrors> table = evaluation::read_table(scene.file("new/table.csv"));
    ASSERT_EQ(table.size(), 4U);
    EXPECT_NEAR(table[0].errors->translation_in_camera_m.x(), 0.002, 1e-10);
    EXPECT_NEAR(table[0].visibility->distance_m, 0.36, 0.05);
    EXPECT_TRUE(table[0].visibility->visible_fraction.has_value());
    EXPECT_FALSE(table[1].errors.has_value());
    EXPECT_EQ(run_nearpose(evaluate(scene) + "--out -").out, read_text(scene.file("new/table.csv")));
}

TEST(Evaluate, TheLogGivesRegionsAndPredictedFrames) {
    const TinyScene scene(4);
    const std::vector<data_set::PoseRow> rows = some_rows(scene, 0.002);  // at two standard deviations
    write_results(scene, rows);
    write_log(scene, rows);
    const std::string call = evaluate(scene) + "--log " + scene.file("log.jsonl").string() + " ";
    const Outcome outcome =
        run_nearpose(call + "--json " + scene.file("all.json").string() + " --calibration " +
                     scene.file("calibration.png").string() + " --curves " + scene.file("curves.png").string());
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_TRUE(contains(outcome.out, "1 predicted")) << outcome.out;
    EXPECT_TRUE(contains(outcome.out, "90 % region: 100.0 % of 3 frames (95 % interval 43.9 % to 100.0 %)"));
    const nlohmann::json figures = nlohmann::json::parse(read_text(scene.file("all.json")));
    EXPECT_EQ(figures.at("format"), 1);
    EXPECT_EQ(figures.at("frames_predicted"), 1);
    EXPECT_NEAR(figures.at("translation_mm").at("mean").get<double>(), 2.0, 1e-9);
    EXPECT_NEAR(figures.at("translation_axis_mm").at("x").at("max").get<double>(), 2.0, 1e-9);
    EXPECT_EQ(figures.at("coarse").at("holds_from_frame"), 2);
    EXPECT_DOUBLE_EQ(figures.at("inside_90").get<double>(), 1.0);
    EXPECT_EQ(figures.at("coverage").at("frames"), 3);
    EXPECT_DOUBLE_EQ(figures.at("coverage").at("inside_99").get<double>(), 1.0);
    int frames_in_bins = 0;
    for (const nlohmann::json& bin : figures.at("coverage_by_distance")) {
        EXPECT_LT(bin.at("from_mm").get<double>(), bin.at("to_mm").get<double>());
        EXPECT_GT(bin.at("to_mm").get<double>(), 200.0);  // the part is 0.36 m away
        EXPECT_LT(bin.at("from_mm").get<double>(), 500.0);
        frames_in_bins += bin.at("frames").get<int>();
    }
    EXPECT_EQ(frames_in_bins, 3);
    EXPECT_TRUE(contains(outcome.out, " mm            ") && contains(outcome.out, "  all distances")) << outcome.out;
    EXPECT_EQ(run_nearpose(call + "--json -").out, read_text(scene.file("all.json")));
    EXPECT_EQ(data_set::read_png_size(scene.file("calibration.png")).width, 900);
    EXPECT_EQ(data_set::read_png_size(scene.file("curves.png")).width, 900);

    write_log(scene, some_rows(scene, 0.003));
    const Outcome other = run_nearpose(call);
    EXPECT_EQ(other.exit_code, 1);
    EXPECT_TRUE(contains(other.err, "log.jsonl: line 2") && contains(other.err, "poses.csv")) << other.err;
    write_text(scene.file("log.jsonl"), "{\"format\": 1}\n");
    EXPECT_EQ(run_nearpose(call).exit_code, 1);
    write_text(scene.file("log.jsonl"), program::first_log_line({}) + "\n{\"frame\": 0, \"sta");
    EXPECT_TRUE(contains(run_nearpose(call).err, "log.jsonl: line 2"));
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

TEST(Evaluate, TrajectoriesHaveTheSameStampsAndTheErrorOfTheSummary) {
    const TinyScene scene(4);
    write_results(scene, some_rows(scene, 0.002));
    const Outcome outcome = run_nearpose(evaluate(scene) + "--trajectory-out " + scene.file("evo").string());
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const auto truth = data_set::read_tum(scene.file("evo/truth.tum")),
               poses = data_set::read_tum(scene.file("evo/poses.tum"));
    ASSERT_EQ(truth.size(), 3U);
    ASSERT_EQ(poses.size(), 3U);
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(truth[i].stamp_s, poses[i].stamp_s);
        EXPECT_NEAR((poses[i].pose.translation - truth[i].pose.translation).norm(), 0.002, 1e-8);
    }
}

// Files as they should not be; each says what is wrong.
class EvaluateRefuses : public testing::Test {
  protected:
    EvaluateRefuses() : scene_(4) { write_results(scene_, some_rows(scene_, 0.002)); }

    void expect_failure(const std::vector<std::string>& parts, const std::string& more = "", int exit_code = 1) {
        const Outcome outcome = run_nearpose(evaluate(scene_) + more);
        EXPECT_EQ(outcome.exit_code, exit_code) << outcome.err;
        for (const std::string& part : parts) EXPECT_TRUE(contains(outcome.err, part)) << outcome.err;
    }
    // Changes the text of a file in the scene.
    void edit(const std::filesystem::path& file, const std::string& from, const std::string& to) {
        std::string text = read_text(file);
        ASSERT_TRUE(contains(text, from)) << text;
        text.replace(text.find(from), from.size(), to);
        write_text(file, text);
    }

    TinyScene scene_;
};

TEST_F(EvaluateRefuses, ResultsOfAnotherSceneOrObject) {
    write_results(scene_, some_rows(scene_, 0.0, 8));
    expect_failure({"poses.csv", "no row of scene 7, but of scene 8"});
    EXPECT_EQ(run_nearpose(evaluate(scene_) + "--scene-id 8").exit_code, 0);
    std::vector<data_set::PoseRow> rows = some_rows(scene_, 0.0);
    for (data_set::PoseRow& row : rows) row.object_id = 5;
    write_results(scene_, rows);
    expect_failure({"poses.csv", "no row of object 1, but of object 5"});
}

TEST_F(EvaluateRefuses, BrokenResults) {
    const std::string good = read_text(scene_.file("poses.csv"));
    write_text(scene_.file("poses.csv"), lines_of(good)[0] + "\n7,0,1,nan,1 0 0 0 1 0 0 0 1,0 0 1,1\n");
    expect_failure({"poses.csv", "line 2", "score"});
    write_text(scene_.file("poses.csv"), good.substr(0, good.size() - 60));  // cut short
    expect_failure({"poses.csv", "line 4"});
    write_text(scene_.file("poses.csv"), lines_of(good)[0] + "\n");
    expect_failure({"poses.csv", "no results"});
    std::filesystem::remove(scene_.file("poses.csv"));
    expect_failure({"poses.csv"});
}

TEST_F(EvaluateRefuses, FramesThatTheSceneLacks) {
    std::vector<data_set::PoseRow> rows = some_rows(scene_, 0.0);
    rows.back().image_id = 99;
    write_results(scene_, rows);
    expect_failure({"poses.csv", "image 99", "scene 7"});
}

TEST_F(EvaluateRefuses, ScenesWithoutTruth) {
    expect_failure({"first"}, "--first 100");
    for (std::size_t frame = 0; frame < scene_.truth().size(); ++frame) {
        edit(scene_.scene() / "scene_gt.json", "\"obj_id\": 1", "\"obj_id\": 2");
    }
    expect_failure({"scene_gt.json", "object 1"});
    std::filesystem::remove(scene_.scene() / "scene_gt.json");
    expect_failure({"scene_gt.json"});
}

TEST_F(EvaluateRefuses, ModelsThatAreNotDescribed) {
    std::filesystem::rename(scene_.models() / "models_info.json", scene_.file("info.json"));
    expect_failure({"models_info.json"});
    std::filesystem::rename(scene_.file("info.json"), scene_.models() / "models_info.json");
    std::filesystem::remove(scene_.models() / "obj_000001.ply");
    expect_failure({"obj_000001.ply"});
}

TEST_F(EvaluateRefuses, OptionsThatDoNotFit) {
    expect_failure({"--log"}, "--calibration " + scene_.file("c.png").string(), 2);
    expect_failure({"--tolerance-mm", "--log"}, "--tolerance-mm 3", 2);
    expect_failure({"--out"}, "--out same.csv --json same.csv", 2);
}

TEST_F(EvaluateRefuses, CurvesWithoutMasks) {
    std::filesystem::remove_all(scene_.scene() / "mask_visib");
    const Outcome plain = run_nearpose(evaluate(scene_));  // all else goes without
    EXPECT_EQ(plain.exit_code, 0);
    EXPECT_TRUE(contains(plain.err, "mask_visib")) << plain.err;
    expect_failure({"--curves", "mask_visib"}, "--curves " + scene_.file("c.png").string());
}

TEST_F(EvaluateRefuses, ABrokenDepthImageConcernsItsFrameOnly) {
    write_text(scene_.scene() / "depth/000002.png", "no image");
    const Outcome outcome = run_nearpose(evaluate(scene_) + "--out " + scene_.file("t.csv").string());
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_TRUE(contains(outcome.err, "000002.png")) << outcome.err;
    const auto frames = evaluation::read_table(scene_.file("t.csv"));
    EXPECT_FALSE(frames[2].visibility.has_value());
    EXPECT_TRUE(frames[3].visibility.has_value());
}

TEST_F(EvaluateRefuses, NothingWhereTheFractionIsNotKnown) {
    const std::string call = evaluate(scene_) + "--out " + scene_.file("t.csv").string();
    std::filesystem::remove(scene_.scene() / "scene_gt_info.json");
    EXPECT_EQ(run_nearpose(call).exit_code, 0);
    const auto frames = evaluation::read_table(scene_.file("t.csv"));
    EXPECT_TRUE(frames[0].visibility && !frames[0].visibility->visible_fraction);
    write_text(scene_.scene() / "scene_gt_info.json", "{\"0\": []}");
    expect_failure({"scene_gt_info.json", "frame 0"});
}

TEST_F(EvaluateRefuses, NoSecondRowsButSaysSo) {
    std::vector<data_set::PoseRow> rows = some_rows(scene_, 0.002);
    rows.push_back(rows[0]);
    rows.back().score = 0.95;
    rows.back().camera_from_object = moved(scene_.truth()[0], 0.004);
    write_results(scene_, rows);
    const Outcome outcome = run_nearpose(evaluate(scene_) + "--last 0 --out -");
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_TRUE(contains(outcome.err, "1 rows are further ones")) << outcome.err;
    ASSERT_EQ(lines_of(outcome.out).size(), 2U);
    EXPECT_TRUE(contains(outcome.out, "\n0,0,4.00000000,")) << outcome.out;  // the better score's
}

TEST_F(EvaluateRefuses, NoModelsEvalBesideTheModels) {
    const std::filesystem::path eval = scene_.models().parent_path() / "models_eval";
    const std::string full = run_nearpose(evaluate(scene_) + "--json -").out;
    std::filesystem::copy(scene_.models(), eval);
    EXPECT_EQ(run_nearpose(evaluate(scene_) + "--json -").out, full);
    // Its own models_info.json holds, and where it has none that of the models.
    auto info = data_set::read_models_info(eval / "models_info.json");
    info.at(1).diameter_m = 1.0;
    data_set::write_models_info(eval / "models_info.json", info);
    EXPECT_TRUE(contains(run_nearpose(evaluate(scene_)).out, "(to 100.0 mm)"));
    std::filesystem::remove(eval / "models_info.json");
    EXPECT_EQ(run_nearpose(evaluate(scene_) + "--json -").out, full);
}

}  // namespace
}  // namespace nearpose::program_tests
