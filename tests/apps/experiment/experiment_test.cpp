#include "apps/experiment/experiment.hpp"

#include <atomic>

#include "apps/experiment/run_setup.hpp"
#include "apps/tables/results_text.hpp"
#include "tests/apps/support/test_files.hpp"
#include "tests/apps/support/tiny_scene.hpp"

namespace nearpose::experiment {
namespace {

namespace fs = std::filesystem;
using namespace data_set::testing_files;
using program_tests::Outcome;
using program_tests::run_nearpose;
using program_tests::run_shell;

// No figure depends on the time.
constexpr const char* kTiny = R"({"format": 1, "name": "tiny", "tables": [
  {"name": "runs", "columns": ["translation_mean", "held", "translation_median", "frames_to_arrive"],
   "with": {"part": "bracket", "frames": 3, "image_scale": 16, "particles": 4, "method": "paper", "burn_in": 1},
   "rows": [{"scenario": ["baseline", "sweep"], "views": ["raycast", "raster"]}], "seeds": 2,
   "curves": [{"x": "distance", "y": "translation", "bins": 5, "low": 1, "high": 1000}]},
  {"name": "views", "kind": "views", "columns": ["points_per_view", "wrong_percent"],
   "with": {"max_rays": 100, "view_samples": 500, "timed_views": 0, "part": "bracket"},
   "rows": [{"views": ["raycast", "raster"]}], "seeds": 3}]})";
constexpr int kCells = 8 + 6, kUnits = 4 + 6;

class ExperimentTest : public testing::Test {
  protected:
    ExperimentTest() : folder_(new_folder()), file_(write_text(folder_ / "tiny.json", kTiny)) {}

    Description description() const { return read_description(file_); }
    std::vector<Unit> units() const { return units_of(description()); }

    // Runs what is open and tells how many cells that were; with `stop_after`, Ctrl-C comes after so many.
    int run_all(const fs::path& out, Shard shard = {}, int threads = 1, int stop_after = kCells) const {
        const RunOptions options{out, shard, threads, false};
        std::atomic<int> done = 0;
        run(
            work_of(units(), options), folder_, options, [&] { ++done; }, [&] { return done < stop_after; });
        return done;
    }

    // All that a run leaves but times.
    std::string outcome(const fs::path& out) const {
        const tables::Results results = results_of(description(), out);
        tables::write_results(out / "results.json", results);
        std::string all = read_text(out / "results.json");
        for (const Unit& unit : units()) {
            for (const Cell& cell : unit.cells) {
                const std::string json = read_text(cell_folder(out, cell.key) / "cell.json");
                all += json.substr(0, json.find("\"time\""));
                if (cell.kind == TableKind::kRun) all += read_text(cell_folder(out, cell.key) / "frames.csv");
            }
        }
        return all;
    }

    fs::path folder_, file_;
};

TEST_F(ExperimentTest, ThreadsShardsAndInterruptionsChangeNothing) {
    EXPECT_EQ(run_all(folder_ / "one"), kCells);
    const std::string expected = outcome(folder_ / "one");
    EXPECT_NE(expected.find("\"bins\""), std::string::npos);

    for (const int threads : {2, 3}) {
        const fs::path out = folder_ / ("threads" + std::to_string(threads));
        run_all(out, {}, threads);
        EXPECT_EQ(outcome(out), expected) << threads;
    }

    std::vector<fs::path> parts;
    int cells = 0;
    for (const int shard : {3, 1, 2}) {
        parts.push_back(folder_ / ("shard" + std::to_string(shard)));
        cells += run_all(parts.back(), {shard, 3});
        EXPECT_THROW(results_of(description(), parts.back()), std::runtime_error);
    }
    EXPECT_EQ(cells, kCells);
    gather(units(), parts, folder_ / "merged");
    EXPECT_EQ(outcome(folder_ / "merged"), expected);

    const fs::path out = folder_ / "interrupted";
    const int first = run_all(out, {}, 1, 3);
    EXPECT_LT(first, kCells);
    EXPECT_EQ(first + run_all(out), kCells);
    EXPECT_EQ(outcome(out), expected);
}

TEST_F(ExperimentTest, OnlyWhatIsOpenIsRun) {
    const fs::path out = folder_ / "out";
    run_all(out);
    EXPECT_EQ(run_all(out), 0);
    const CellKey run{"runs", description().tables[0].rows[0].slug, 1}, view{"views", "views-raster", 2};
    const std::string whole = read_text(cell_folder(out, run) / "cell.json");
    write_text(cell_folder(out, run) / "cell.json", whole.substr(0, whole.size() / 2));  // half-written
    EXPECT_EQ(missing_cells(units(), out, 1)[0], 1);
    fs::remove(cell_folder(out, view) / "cell.json");
    EXPECT_EQ(missing_cells(units(), out, 1)[0], 2);
    EXPECT_EQ(run_all(out), 2);
    const std::string again = read_text(cell_folder(out, run) / "cell.json");
    EXPECT_EQ(again.substr(0, again.find("\"time\"")), whole.substr(0, whole.find("\"time\"")));
    fs::remove(cell_folder(out, run) / "frames.csv");
    EXPECT_EQ(run_all(out), 1);

    // Other settings: all cells of the table, and those of the other are left alone.
    std::string changed = kTiny;
    changed.replace(changed.find("\"particles\": 4"), 14, "\"particles\": 5");
    write_text(file_, changed);
    EXPECT_EQ(missing_cells(units(), out, 1)[0], 8);
    EXPECT_EQ(run_all(out), 8);
}

TEST_F(ExperimentTest, SharingARecordingChangesNothing) {
    run_all(folder_ / "together");
    std::vector<Unit> alone;
    for (const Unit& unit : units()) {
        for (const Cell& cell : unit.cells) {
            if (cell.kind == TableKind::kRun) alone.push_back({{cell}});
        }
    }
    const RunOptions options{folder_ / "alone", {}, 1, false};
    run(
        alone, folder_, options, [] {}, [] { return true; });
    for (const Unit& unit : alone) {
        const CellKey& key = unit.cells[0].key;
        const std::string frames = read_text(cell_folder(folder_ / "alone", key) / "frames.csv");
        EXPECT_FALSE(frames.empty());
        EXPECT_EQ(frames, read_text(cell_folder(folder_ / "together", key) / "frames.csv"));
    }
}

TEST_F(ExperimentTest, TheBatchScriptsTasksGiveWhatOneRunGives) {
    const std::string command = " experiment " + file_.string() + " --out " + folder_.string();
    ASSERT_EQ(run_nearpose(command + "/one --threads 1").exit_code, 0);
    const auto task = [&](int id, const std::string& more = "") {
        return run_shell("export NEARPOSE SLURM_ARRAY_TASK_MIN=5 SLURM_ARRAY_TASK_COUNT=3 SLURM_CPUS_PER_TASK=1\n" +
                         more + "SLURM_ARRAY_TASK_ID=" + std::to_string(id) +
                         " bash apps/experiments/experiment.sbatch " + file_.string() + " " +
                         (folder_ / "array").string());
    };
    EXPECT_EQ(task(7).exit_code, 0);
    EXPECT_EQ(task(5).exit_code, 0);
    EXPECT_FALSE(fs::exists(folder_ / "array/results.json"));
    const Outcome early = task(0, "MERGE=1 SHARDS=3 ");
    EXPECT_EQ(early.exit_code, 1);
    EXPECT_NE(early.err.find("shard 2 of 3 lacks"), std::string::npos) << early.err;
    EXPECT_EQ(early.err.find("shard 1 of 3"), std::string::npos) << early.err;
    EXPECT_EQ(task(6).exit_code, 0);  // the last one writes the results
    for (const char* name : {"results.json", "results.csv", "results.md"}) {
        EXPECT_EQ(read_text(folder_ / "array" / name), read_text(folder_ / "one" / name)) << name;
    }
    EXPECT_TRUE(fs::exists(folder_ / "array/runs-1.png"));
    EXPECT_EQ(run_shell("bash apps/experiments/experiment.sbatch x.json").exit_code, 2);
}

TEST_F(ExperimentTest, TellsWhatIsThereAndWhatIsWrong) {
    const std::string command = "experiment " + file_.string() + " --out " + (folder_ / "out").string();
    const Outcome list = run_nearpose(command + " --list --shards 2");
    EXPECT_EQ(list.exit_code, 0);
    EXPECT_EQ(program_tests::lines_of(list.out).size(), static_cast<std::size_t>(kCells + 1));
    EXPECT_NE(list.out.find("14 cells are open"), std::string::npos) << list.out;
    EXPECT_FALSE(fs::exists(folder_ / "out"));
    const auto refuses = [&](const std::string& options, int exit_code, const std::string& part) {
        const Outcome outcome = run_nearpose(command + options);
        EXPECT_EQ(outcome.exit_code, exit_code) << options;
        EXPECT_NE(outcome.err.find(part), std::string::npos) << outcome.err;
    };
    refuses(" --shard 4/3", 2, "must be i/n");
    refuses(" --only vews", 2, "did you mean views");
    refuses(" --merge --again", 2, "runs nothing");
    refuses(" --merge-from " + folder_.string(), 1, "has no folder cells");
    refuses(" --merge", 1, "lacks 14 cells");
    const Outcome only = run_nearpose(command + " --only views --seeds 1");
    EXPECT_EQ(only.exit_code, 0) << only.err;
    EXPECT_EQ(program_tests::lines_of(read_text(folder_ / "out/results.csv")).size(), 1U + 2U * 2U);
}

TEST(ResultsText, KeepsTheShapeOfTables) {
    tables::Results results{"name", "command", {}};
    tables::Table& table = results.tables.emplace_back();
    table.name = "t";
    table.title = "A table";
    table.columns = {{"error", "mm", 1}, {"share", "%", 0}};
    table.rows = {{"a|b, \"c\"", 20, {{1.25, 1.0, 2.0}, {}}}};
    const std::string markdown = tables::markdown_of(results, {});
    EXPECT_NE(markdown.find("| a\\|b, \"c\" | 20 | 1.2 [1.0, 2.0] | - |"), std::string::npos) << markdown;
    EXPECT_EQ(tables::csv_of(results),
              "table,row,runs,column,unit,value,low,high\n"
              "t,\"a|b, \"\"c\"\"\",20,error,mm,1.25,1,2\n"
              "t,\"a|b, \"\"c\"\"\",20,share,%,,,\n");
}

}  // namespace
}  // namespace nearpose::experiment
