#include "apps/experiment/description.hpp"

#include <set>

#include "apps/experiment/column.hpp"
#include "apps/experiment/experiment.hpp"
#include "apps/experiment/run_setup.hpp"
#include "tests/apps/support/test_files.hpp"

namespace nearpose::experiment {
namespace {

using namespace data_set::testing_files;

// A description of one table with these rows, and what else is given.
Description described(const std::string& rows, const std::string& more = "") {
    const std::filesystem::path file = new_folder() / "tiny.json";
    write_text(file, R"({"format": 1, "name": "tiny", "tables": [{"name": "first", "columns": ["translation_mean"],
        "seeds": 2, "rows": )" +
                         rows + (more.empty() ? "" : ", " + more) + "}]}");
    Description description = read_description(file);
    check(description);
    return description;
}

TEST(Description, RowsAreTheProductOfTheirLists) {
    const Description description = described(
        R"([{"scenario": ["baseline", "piston"], "particles": [50, 100, 200]}, {"rounds": 2, "scenario": "sweep"}])");
    const std::vector<RowSpec>& rows = description.tables[0].rows;
    ASSERT_EQ(rows.size(), 7U);
    const char* scenarios[] = {"baseline", "baseline", "baseline", "piston", "piston", "piston", "sweep"};
    const double particles[] = {50, 100, 200, 50, 100, 200, 200};  // the last is what is usual
    for (std::size_t i = 0; i < rows.size(); ++i) {
        EXPECT_EQ(setting<std::string>(rows[i].settings, "scenario"), scenarios[i]);
        EXPECT_EQ(setting<double>(rows[i].settings, "particles"), particles[i]);
    }
    EXPECT_EQ(rows[1].label, "baseline, particles 100");
    EXPECT_EQ(rows[6].label, "sweep, rounds 2");
}

TEST(Description, CommonListsMultiplyRowsAndGiveWayToTheirOwn) {
    const Description description =
        described(R"([{}, {"label": "few", "particles": 10}, {"label": "only", "scenario": "sweep"}])",
                  R"("with": {"scenario": ["baseline", "piston"], "frames": 7})");
    std::vector<std::string> labels;
    for (const RowSpec& row : description.tables[0].rows) {
        labels.push_back(row.label);
        EXPECT_EQ(setting<double>(row.settings, "frames"), 7.0);
    }
    EXPECT_EQ(labels, (std::vector<std::string>{"baseline", "piston", "few, baseline", "few, piston", "only"}));
}

TEST(Description, ARowKeepsItsFolderWhenOthersAreAdded) {
    const std::string row = R"({"scenario": "piston", "arm_mm": 0.5})";
    const std::string alone = described("[" + row + "]").tables[0].rows[0].slug;
    const Description more = described(R"([{"scenario": "sweep", "rounds": [2, 3]}, )" + row + "]");
    EXPECT_EQ(more.tables[0].rows[2].slug, alone);
}

TEST(Description, FoldersAreSafeAndDifferent) {
    std::set<std::string> slugs;
    for (const std::string& text : {std::string("a b"), std::string("a/b"), std::string("a-b"), std::string(".."),
                                    std::string("\xc3\xa9"), std::string(300, 'x'), std::string(301, 'x')}) {
        const std::string slug = slug_of(text);
        EXPECT_TRUE(slugs.insert(slug).second) << text;
        EXPECT_LE(slug.size(), 80U);
        EXPECT_NE(slug[0], '.');
        for (const char c : slug) EXPECT_TRUE(std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '.');
    }
    EXPECT_EQ(slug_of("method-paper_rounds-2"), "method-paper_rounds-2");
}

TEST(Description, SaysWhatIsWrongAndWhere) {
    const auto refuses = [](const std::string& rows, const std::string& more, std::vector<std::string> parts) {
        parts.push_back("tiny.json");
        expect_error([&] { described(rows, more); }, parts);
    };
    refuses(R"([{"particle": 3}])", "", {"tables/0/rows/0/particle", "did you mean particles"});
    refuses(R"([{"particles": "many"}])", "", {"tables/0/rows/0/particles", "must be a number"});
    refuses(R"([{"particles": [100, 0.5]}])", "", {"tables/0/rows/0/particles/1", "whole number"});
    refuses(R"([{"particles": 0}])", "", {"tables/0/rows/0/particles", "1..1000000"});
    refuses(R"([{"control": 1}])", "", {"tables/0/rows/0/control"});
    refuses(R"([{"scenario": "pistol"}])", "", {"tables/0/rows/0/scenario", "did you mean piston"});
    refuses(R"([{"cad": "miror"}])", "", {"tables/0/rows/0/cad", "did you mean mirrored"});
    refuses(R"([{"scene": "empy"}])", "", {"tables/0/rows/0/scene", "did you mean empty"});
    refuses(R"([{"start": "turth"}])", "", {"tables/0/rows/0/start", "did you mean truth"});
    refuses(R"([{"nonsense_frames": -1}])", "", {"tables/0/rows/0/nonsense_frames", "0..100000"});
    refuses(R"([{"tolerance_mm": 0}])", "", {"tables/0/rows/0/tolerance_mm"});
    refuses(R"([{"particles": []}])", "", {"tables/0/rows/0/particles", "empty list"});
    refuses("[]", "", {"tables/0/rows", "empty"});
    refuses(R"([{"rounds": 2}, {"rounds": [1, 2]}])", "", {"tables/0/rows", "two rows are the same"});
    refuses("[{}]", R"("wiht": {})", {"tables/0/wiht", "did you mean with"});
    refuses("[{}]", R"("kind": "vews")", {"tables/0/kind", "did you mean views"});
    refuses(R"([{"distance_mm": 100}])", "", {"tables/0/rows/0/distance_mm", "no setting of such a table"});
    refuses("[{}]", R"("curves": [{"x": "distance", "y": "translation", "low": 3, "high": 2}])",
            {"tables/0/curves/0/high"});
    refuses("[{}]", R"("curves": [{"x": "distance", "y": "rotation", "low": 1, "high": 2, "burn_in": -1}])",
            {"tables/0/curves/0/burn_in"});
    refuses("[{}]", R"("curves": [{"x": "time", "y": "translation", "low": 1, "high": 2}])", {"tables/0/curves/0/x"});
}

TEST(Description, SaysWhatDoesNotGoTogether) {
    const auto refuses = [](const std::string& row, const std::string& part) {
        expect_error([&] { described("[" + row + "]"); }, {"tiny.json", "table first", "row \"", part});
    };
    refuses(R"({"overlap": false})", "overlap belongs to the method paper");
    refuses(R"({"view_samples": 100})", "view_samples belongs to rasterised views");
    refuses(R"({"rounds": 0})", "rounds");
    refuses(R"({"gradient": false, "rounds": 2})", "gradient step, which is off");
    refuses(R"({"scenario": "piston", "occlusion": 0.3})", "piston");
    refuses(R"({"model": "no_such.ply"})", "no_such.ply");
    refuses(R"({"sensor": "no_such_sensor"})", "no_such_sensor");
    for (const char* disturbed :
         {R"("look_away": 3)", R"("object_moves": true)", R"("scene": "empty")", R"("scene": "other")"}) {
        for (const char* scenario : {"conveyor", "clutter", "bin"})
            refuses("{" + std::string(disturbed) + R"(, "scenario": ")" + scenario + "\"}",
                    "not " + std::string(scenario));
    }
    refuses(R"({"scene": "empty", "look_away": 2})", "leave out the scene");
    refuses(R"({"scene": "other", "object_moves": true})", "leave out the scene");
    refuses(R"({"scene": "empty", "start": "truth"})", "start truth: there is no true pose");
    refuses(R"({"frames": 12, "look_away": 5})", "look_away");
    refuses(R"({"frames": 12, "nonsense_frames": 10})", "nonsense_frames");
    refuses(R"({"frames": 12, "look_away": 4, "nonsense_frames": 6})", "nonsense_frames");
    refuses(R"({"frames": 10, "dropped": 0.5, "nonsense_frames": 3})", "nonsense_frames");
    EXPECT_NO_THROW(described(R"([{"frames": 12, "look_away": 4, "nonsense_frames": 5, "object_moves": true}])"));
    EXPECT_NO_THROW(described(R"([{"scenario": "bin", "nonsense_frames": 5}])"));
    EXPECT_NO_THROW(described(R"([{"gradient": false, "rounds": 0}])"));
}

TEST(Description, WhatIsUsualOfALaterSettingGoesUnsaid) {
    const Settings before = described("[{}]").tables[0].rows[0].settings;
    for (const char* name :
         {"scene", "nonsense_frames", "look_away", "object_moves", "cad", "start", "tolerance_mm", "tolerance_deg"})
        EXPECT_EQ(before.count(name), 0U) << name;
    const Description said =
        described(R"([{"scene": "part", "nonsense_frames": 0, "look_away": 0, "object_moves": false,
        "cad": "true", "start": "none", "tolerance_mm": 2, "tolerance_deg": 1}, {"cad": ["true", "scaled"]}])");
    EXPECT_EQ(said.tables[0].rows[0].settings, before);
    EXPECT_EQ(said.tables[0].rows[1].settings, before);
    EXPECT_EQ(said.tables[0].rows[1].label, "cad true");
    EXPECT_EQ(setting<std::string>(said.tables[0].rows[2].settings, "cad"), "scaled");
}

TEST(Description, ToleranceReachesTheEstimatorAndTheFigures) {
    const Settings settings = described(R"([{"tolerance_mm": 0.5, "tolerance_deg": 3}])").tables[0].rows[0].settings;
    EXPECT_DOUBLE_EQ(estimator_setup(settings, 1).tolerance.translation_m, 0.0005);
    EXPECT_NEAR(summary_options(settings).tolerance.rotation_rad, 0.0523598775598, 1e-12);
    const Tolerance usual = summary_options(described("[{}]").tables[0].rows[0].settings).tolerance;
    EXPECT_DOUBLE_EQ(usual.translation_m, Tolerance{}.translation_m);
    EXPECT_DOUBLE_EQ(usual.rotation_rad, Tolerance{}.rotation_rad);
}

TEST(Description, RunsOfOneRecordingAreOneUnit) {
    const Description description =
        described(R"([{"scenario": ["baseline", "piston"], "particles": [50, 100]}, {"mask": false}])");
    const std::vector<Unit> units = units_of(description);  // the last row tracks the same recording as the second
    ASSERT_EQ(units.size(), 4U);
    std::size_t cells = 0;
    for (const Unit& unit : units) {
        cells += unit.cells.size();
        for (const Cell& cell : unit.cells) {
            EXPECT_EQ(cell.key.seed, unit.cells[0].key.seed);
            EXPECT_EQ(cell.settings.at("scenario"), unit.cells[0].settings.at("scenario"));
        }
    }
    EXPECT_EQ(cells, 10U);
    for (int n = 1; n <= 5; ++n) {
        std::vector<int> count(static_cast<std::size_t>(n), 0);
        for (std::size_t u = 0; u < units.size(); ++u) ++count.at(static_cast<std::size_t>(shard_of(u, n) - 1));
        for (const int units_of_shard : count) EXPECT_LE(std::abs(units_of_shard - 4 / n), 1);
    }
}

TEST(Description, AFaultIsCheckedBeforeHoursAreSpent) {
    const Description good = described(R"([{"fault": ["none", "frozen@3-"]}])");
    EXPECT_EQ(good.tables[0].rows[0].settings.count("fault"), 0U);  // as a row that says nothing of it
    EXPECT_EQ(recording_options(good.tables[0].rows[0].settings, 1, ".").faults.size(), 0U);
    EXPECT_EQ(recording_options(good.tables[0].rows[1].settings, 1, ".").faults.at(0).first, 3);
    for (const char* bad : {R"([{"fault": "frozne@all"}])", R"([{"fault": "frozen@9-", "frames": 9}])"})
        EXPECT_THROW(described(bad), std::runtime_error) << bad;
}

TEST(Description, ShardsAreReadStrictly) {
    EXPECT_EQ(parse_shard("2/5").shard, 2);
    for (const char* text : {"0/3", "4/3", "1", "1/0", "a/3", "1/3/4", "-1/3", "1/", "/3", ""})
        EXPECT_THROW(parse_shard(text), std::invalid_argument) << text;
}

TEST(Description, ShippedOnesAreGood) {
    for (const char* name : {"small.json", "evaluation.json", "accuracy.json", "faults.json"}) {
        const Description description = read_description(std::filesystem::path("apps/experiments") / name);
        EXPECT_NO_THROW(check(description)) << name;
    }
}

TEST(Description, ThoseOfStereoSensorsAreGoodWhereTheyAreBuilt) {
    for (const char* name : {"stereo.json", "reality.json"}) {
        const Description description = read_description(std::filesystem::path("apps/experiments") / name);
        if (!simulate::stereo_is_built()) GTEST_SKIP() << "built without OpenCV: no stereo matching";
        EXPECT_NO_THROW(check(description)) << name;
    }
}

}  // namespace
}  // namespace nearpose::experiment
