// Files and options that evaluate refuses, or goes on without.
#include <gtest/gtest.h>

#include "apps/data_set/bop_models.hpp"
#include "apps/error_measures/frame_errors.hpp"
#include "tests/apps/evaluate/some_results.hpp"

namespace nearpose::program_tests {
namespace {

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
