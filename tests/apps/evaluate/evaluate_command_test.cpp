// evaluate, run as a user would.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "apps/data_set/png_file.hpp"
#include "apps/data_set/trajectory_tum.hpp"
#include "apps/error_measures/frame_errors.hpp"
#include "tests/apps/evaluate/some_results.hpp"

namespace nearpose::program_tests {
namespace {

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

}  // namespace
}  // namespace nearpose::program_tests
