// nearpose compare, run as a user would.
#include <gtest/gtest.h>

#include "apps/tables/results.hpp"
#include "tests/apps/support/tiny_scene.hpp"

namespace nearpose::compare {
namespace {

using program_tests::Outcome;
using program_tests::run_nearpose;
using program_tests::TinyScene;

bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

TEST(CompareCommand, ComparesViewsAlone) {
    const TinyScene scene(1);
    const std::string out = scene.file("out").string();
    const Outcome outcome = run_nearpose(
        "compare --views-only --part bracket --seeds 2 --distances-mm 300,100 --samples 500 --rays 500 "
        "--views raycast,raster,sphere --threads 1 --out " +
        out);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_TRUE(contains(outcome.out, "100 mm, raster 500")) << outcome.out;
    const tables::Results results = tables::read_results(scene.file("out/results.json"));
    ASSERT_EQ(results.tables.size(), 1U);
    const tables::Table& table = results.tables[0];
    ASSERT_EQ(table.rows.size(), 6U);
    EXPECT_EQ(table.rows[0].label, "300 mm, raycast");
    EXPECT_EQ(table.rows[0].runs, 2);
    EXPECT_EQ(table.columns.at(2).title, "missing");
    EXPECT_LT(*table.rows[0].entries.at(2).value, 1.0);   // of rays
    EXPECT_GT(*table.rows[4].entries.at(2).value, 20.0);  // of the few samples, at 100 mm
    ASSERT_EQ(table.curve_sets.size(), 2U);
    ASSERT_EQ(table.curve_sets[0].curves.size(), 3U);
    EXPECT_EQ(table.curve_sets[0].curves[1].bins.at(0).x, 100.0);
    EXPECT_TRUE(std::filesystem::is_regular_file(scene.file("out/views.png")));
}

TEST(CompareCommand, ComparesInTheFilterOnASweep) {
    const TinyScene scene(1);
    const std::string call =
        "compare --part bracket --seeds 1 --distances-mm 300,200 --samples 200 --rays 200 --views raycast,raster "
        "--methods paper --particles 8 --frames 3 --filter-samples 500 --out " +
        scene.file("out").string();
    const Outcome outcome = run_nearpose(call);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_TRUE(contains(outcome.out, "paper, raster")) << outcome.out;
    EXPECT_EQ(tables::read_results(scene.file("out/results.json")).tables.size(), 4U);
    EXPECT_TRUE(std::filesystem::is_regular_file(scene.file("out/filter.png")));
}

TEST(CompareCommand, ComparesOnARecordedScene) {
    const TinyScene scene(2);
    const std::string call = "compare --scene " + scene.scene().string() + " --models " + scene.models().string() +
                             " --object 1 --views raycast,raster --methods paper --seeds 1 --particles 8 ";
    const Outcome outcome = run_nearpose(call + "--distances-mm 400");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_TRUE(contains(outcome.out, "paper, raster")) << outcome.out;
    EXPECT_FALSE(contains(outcome.out, "Views alone")) << outcome.out;
    std::filesystem::remove(scene.scene() / "scene_gt.json");
    const Outcome no_truth = run_nearpose(call);
    EXPECT_EQ(no_truth.exit_code, 1);
    EXPECT_TRUE(contains(no_truth.err, "scene_gt.json")) << no_truth.err;
}

TEST(CompareCommand, SaysWhatDoesNotFit) {
    for (const char* call : {"--distances-mm 5", "--distances-mm 100,20000", "--samples 0", "--views photographs",
                             "--seeds 0", "--part teapot", "--part bracket --model part.ply", "--models folder",
                             "--scene folder", "--unit mm", "--scene a --models b --views-only"}) {
        EXPECT_EQ(run_nearpose(std::string("compare ") + call).exit_code, 2) << call;
    }
}

}  // namespace
}  // namespace nearpose::compare
