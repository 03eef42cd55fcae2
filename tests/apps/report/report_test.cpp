#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "apps/report/experiment_report.hpp"
#include "apps/report/page.hpp"
#include "apps/report/quantised.hpp"
#include "apps/report/run_report.hpp"
#include "apps/report/shown_mesh.hpp"
#include "apps/report/text_forms.hpp"
#include "apps/tables/results.hpp"
#include "tests/apps/support/tiny_scene.hpp"

namespace nearpose::report {
namespace {

using program_tests::read_text;
using program_tests::run_nearpose;
using program_tests::TinyScene;
using program_tests::write_text;

std::string base64_of_text(std::string_view text) {
    return base64(std::as_bytes(std::span(text)));
}

bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != text.npos;
}

// The examples of RFC 4648.
TEST(ReportText, Base64) {
    EXPECT_EQ(base64_of_text(""), "");
    EXPECT_EQ(base64_of_text("f"), "Zg==");
    EXPECT_EQ(base64_of_text("fo"), "Zm8=");
    EXPECT_EQ(base64_of_text("foo"), "Zm9v");
    EXPECT_EQ(base64_of_text("foobar"), "Zm9vYmFy");
    EXPECT_EQ(base64_of_text("\xff\xfe\xfd"), "//79");
}

TEST(ReportText, NamesEndNeitherTagNorScript) {
    EXPECT_EQ(html_escaped("<b a=\"1\">&'</b>"), "&lt;b a=&quot;1&quot;&gt;&amp;&#39;&lt;/b&gt;");
    EXPECT_EQ(script_safe("{\"a\":\"</script><!--\"}"), "{\"a\":\"\\u003c/script>\\u003c!--\"}");
}

TEST(Quantised, ErrorsAreAtMostHalfAStep) {
    std::vector<Eigen::Vector3f> points;
    for (int i = 0; i < 500; ++i) {
        const auto x = static_cast<float>(i);
        points.emplace_back(0.3F * std::sin(x), 0.01F * std::cos(2.0F * x), 0.5F + 0.1F * std::sin(3.0F * x));
    }
    const QuantisedPoints quantised = quantise(points);
    EXPECT_LT(quantised.step_m, 0.61 / 65534.0);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Eigen::Vector3d error = point_of(quantised, i) - points[i].cast<double>();
        EXPECT_LE(error.cwiseAbs().maxCoeff(), 0.5001 * quantised.step_m);
    }
    EXPECT_TRUE(quantise({}).values.empty());
    const QuantisedPoints one = quantise({{1.0F, 2.0F, 3.0F}});
    EXPECT_LT((point_of(one, 0) - Eigen::Vector3d(1.0, 2.0, 3.0)).norm(), 1e-9);
}

TEST(ShownMesh, StaysAsItIsOrShrinksWithinItsBox) {
    const int side = 80;
    Mesh plate;
    for (int i = 0; i < side * side; ++i) {
        plate.vertices_in_object.emplace_back(0.01F * static_cast<float>(i % side),
                                              0.01F * static_cast<float>(i / side), 0.0F);
    }
    for (int y = 0; y + 1 < side; ++y) {
        for (int x = 0; x + 1 < side; ++x) {
            const int i = y * side + x;
            plate.triangles.push_back({i, i + 1, i + side});
            plate.triangles.push_back({i + 1, i + side + 1, i + side});
        }
    }
    EXPECT_EQ(shown_mesh(plate, 100000).triangles.size(), plate.triangles.size());
    const Mesh coarse = shown_mesh(plate, 2000);
    EXPECT_LE(coarse.triangles.size(), 2000U);
    EXPECT_GT(coarse.triangles.size(), 400U);
    EXPECT_GT(extent_of(coarse).diameter_m(), 0.93 * extent_of(plate).diameter_m());
    EXPECT_LE(extent_of(coarse).diameter_m(), extent_of(plate).diameter_m());
}

class RunReport : public testing::Test {
  protected:
    RunReport() {
        const auto outcome = run_nearpose("estimate " + scene_.input() + "--quiet --run " + run_.string());
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    }
    // What the report cannot do, in one line.
    std::string problem(const RunReportOptions& options = {}) const {
        try {
            run_report(run_, options, [](const std::string&) {});
        } catch (const std::runtime_error& error) {
            return error.what();
        }
        return {};
    }

    TinyScene scene_;
    std::filesystem::path run_ = scene_.file("run");
};

TEST_F(RunReport, HoldsTheRunAndErrors) {
    std::vector<std::string> notices;
    const Report report = run_report(run_, {}, [&](const std::string& text) { notices.push_back(text); });
    EXPECT_TRUE(notices.empty()) << notices.front();
    for (const char* part : {"\"kind\":\"run\"", "\"method\":\"default\"", "\"compiler\":", "\"nearpose\":",
                             "\"revision\":", "error_mm", "particles_float32", "depth_png"}) {
        EXPECT_TRUE(contains(report.json, part)) << part;
    }
    EXPECT_LT(report.json.size(), 1'000'000U);
    if (viewer_available()) {
        const std::string html = page(report.title, report.json);
        EXPECT_TRUE(contains(html, "Permission is hereby granted")) << "licence texts";
        EXPECT_LT(html.find("Content-Security-Policy"), html.find("<style>")) << "the policy comes before all it rules";
        EXPECT_TRUE(contains(html, "default-src 'none'; script-src 'sha256-"));
    }
}

// The log's lines with `change` made to each frame, and the report of that run.
class RunReportOfALog : public RunReport {
  protected:
    nlohmann::json report_with(const std::function<void(nlohmann::json&)>& change) const {
        const std::vector<std::string> lines = program_tests::lines_of(read_text(run_ / "log.jsonl"));
        std::string text = lines.front() + "\n";
        for (std::size_t i = 1; i < lines.size(); ++i) {
            nlohmann::json line = nlohmann::json::parse(lines[i]);
            change(line);
            text += line.dump() + "\n";
        }
        write_text(run_ / "log.jsonl", text);
        return nlohmann::json::parse(run_report(run_, {}, [](const std::string&) {}).json);
    }
};

TEST_F(RunReportOfALog, HoldsVerdictsAndTheLogsSentences) {
    const nlohmann::json missing = {{{"requirement", "agreement"}, {"text", "too little agrees: 0.81, wanted 0.93"}},
                                    {{"requirement", "colour"}, {"text", "the colour is wrong"}}};
    const nlohmann::json report = report_with([&](nlohmann::json& line) {
        const bool last = line["frame"] == 2;
        line["verdict"] = last ? "lost" : "accept";
        line["missing"] = last ? missing : nlohmann::json::array();
    });
    EXPECT_EQ(report["frames"][1]["verdict"], "accept");
    EXPECT_EQ(report["frames"][1]["missing"], nlohmann::json::array());
    EXPECT_EQ(report["frames"][2]["missing"], missing);
    const nlohmann::json& verdicts = report["figures"]["verdicts"];
    EXPECT_EQ(verdicts["frames"], 3);
    EXPECT_EQ(verdicts["accept"], 2);
    EXPECT_EQ(verdicts["lost"], 1);
    ASSERT_EQ(verdicts["lacks"].size(), 2U);
    EXPECT_EQ(verdicts["lacks"][0]["title"], "agreement with the image");
    EXPECT_EQ(verdicts["lacks"][0]["frames"], 1);
    EXPECT_EQ(verdicts["lacks"][0]["first_frame"], 2);
    EXPECT_EQ(verdicts["lacks"][1]["title"], "colour") << "a requirement of a newer program";
}

TEST_F(RunReportOfALog, ShowsThePartInTheWorldAndWhatWasConcludedOfTheArm) {
    const nlohmann::json arm = report_with([](nlohmann::json& line) {
        if (line["frame"] == 1) line["arm"]["cause"] = "depth scale";
    })["arm"];
    ASSERT_EQ(arm["frames"].size(), 3U);
    for (const nlohmann::json& frame : arm["frames"])
        for (const nlohmann::json& shift_mm : frame["shift_mm"]) EXPECT_LT(std::abs(shift_mm.get<double>()), 3.0);
    EXPECT_EQ(arm["events"], nlohmann::json({"", "cause", ""}));
    ASSERT_EQ(arm["conclusions"].size(), 1U);
    EXPECT_TRUE(contains(arm["conclusions"][0].get<std::string>(), "depth scale")) << arm["conclusions"];
    EXPECT_TRUE(contains(arm["conclusions"][0].get<std::string>(), "in frame 1")) << arm["conclusions"];
}

TEST_F(RunReportOfALog, LeavesTheArmOutWhereTheLogHasNone) {
    const nlohmann::json report = report_with([](nlohmann::json& line) {
        line.erase("world_from_object");
        line.erase("arm");
    });
    EXPECT_TRUE(report["arm"].is_null());
    EXPECT_EQ(report["frames"].size(), 3U);
}

TEST_F(RunReportOfALog, ReadsLogsThatDoNotSayWhy) {
    const nlohmann::json without_reasons = report_with([](nlohmann::json& line) { line.erase("missing"); });
    EXPECT_TRUE(without_reasons["frames"][0]["missing"].empty());
    EXPECT_EQ(without_reasons["figures"]["verdicts"]["frames"], 3);
    EXPECT_TRUE(without_reasons["figures"]["verdicts"]["lacks"].empty());

    const nlohmann::json without_verdicts = report_with([](nlohmann::json& line) {
        line.erase("verdict");
        line.erase("agreement");
    });
    EXPECT_FALSE(without_verdicts["frames"][0].contains("verdict"));
    EXPECT_TRUE(without_verdicts["figures"]["verdicts"].is_null());
}

TEST_F(RunReport, GoesWithoutTruthAndParticles) {
    std::filesystem::remove(run_ / "particles.jsonl");
    std::filesystem::remove(scene_.scene() / "scene_gt.json");
    std::vector<std::string> notices;
    RunReportOptions options;
    const Report report = run_report(run_, options, [&](const std::string& text) { notices.push_back(text); });
    EXPECT_EQ(notices.size(), 2U);
    EXPECT_FALSE(contains(report.json, "error_mm"));
}

TEST_F(RunReport, SaysWhatIsWrong) {
    const std::string record = read_text(run_ / "run.json");
    const std::string particles = read_text(run_ / "particles.jsonl");
    write_text(run_ / "particles.jsonl", particles.substr(0, particles.size() - 9));
    EXPECT_TRUE(contains(problem(), "particles.jsonl line 4: is cut short")) << problem();
    write_text(run_ / "particles.jsonl", particles);

    std::string poses = read_text(run_ / "poses.csv");
    poses.replace(poses.find("\n7,") + 1, 1, "9");
    const std::string good_poses = read_text(run_ / "poses.csv");
    write_text(run_ / "poses.csv", poses);
    EXPECT_TRUE(contains(problem(), "poses.csv: has poses of object 1 in scene 9")) << problem();
    write_text(run_ / "poses.csv", good_poses);

    const std::filesystem::path moved = scene_.folder() / "test/000008";
    std::filesystem::rename(scene_.scene(), moved);
    EXPECT_TRUE(contains(problem(), "test/000007")) << problem();
    EXPECT_TRUE(contains(problem(), "--scene DIR")) << problem();
    RunReportOptions told;
    told.scene = moved;
    EXPECT_EQ(problem(told), "");
}

TEST(ReportCommand, NamesWhatItLookedFor) {
    const std::filesystem::path folder =
        std::filesystem::path(testing::TempDir()) / "ReportCommand.NamesWhatItLookedFor";
    std::filesystem::create_directories(folder);
    const auto outcome = run_nearpose("report " + folder.string());
    EXPECT_EQ(outcome.exit_code, 1);
    if (viewer_available()) {
        EXPECT_TRUE(contains(outcome.err, "run.json")) << outcome.err;
        EXPECT_TRUE(contains(outcome.err, "results.json")) << outcome.err;
    } else {
        EXPECT_TRUE(contains(outcome.err, "nodejs")) << outcome.err;
    }
    EXPECT_EQ(run_nearpose("estimate --scene x --models y").exit_code, 2) << "nothing to write";
}

TEST(ExperimentReport, HoldsTablesAndCurves) {
    const std::filesystem::path folder =
        std::filesystem::path(testing::TempDir()) / "ExperimentReport.HoldsTablesAndCurves";
    std::filesystem::create_directories(folder);
    tables::Table table{"t", "</script>", "text", {{"error", "mm", 2}}, {}, {}};
    table.rows.push_back({"piston", 20, {{0.5, 0.25, 0.75}}});
    table.curve_sets.push_back({"c", "distance", "error", true, {{"raycast", {{0.1, 3, 1.0, 0.5, 1.5, 2.0}}}}});
    tables::write_results(folder / "results.json", {"paper", "nearpose experiment", {table}});
    const Report report = experiment_report(folder / "results.json");
    EXPECT_TRUE(contains(report.json, "\"entries\":[[0.5,0.25,0.75]]")) << report.json;
    EXPECT_TRUE(contains(report.json, "\"percentile_75\":[1.5]")) << report.json;
    EXPECT_FALSE(contains(script_safe(report.json), "</script>"));
}

}  // namespace
}  // namespace nearpose::report
