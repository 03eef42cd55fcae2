#include "apps/experiment/experiment_command.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <numeric>

#include "apps/base/console.hpp"
#include "apps/base/file_io.hpp"
#include "apps/base/nearest_word.hpp"
#include "apps/experiment/experiment.hpp"
#include "apps/experiment/run_setup.hpp"
#include "apps/pictures/curve_plot.hpp"
#include "apps/tables/results_text.hpp"

namespace nearpose::program {
namespace {

namespace fs = std::filesystem;
using experiment::Description;
using experiment::Unit;

struct ExperimentOptions {
    fs::path description, out;
    std::string shard = "1/1";
    int threads = 0;
    int seeds = 0;  // 0: as the description says
    std::vector<std::string> only;
    bool again = false, list = false, merge = false;
    int shards = 0;  // that the run was spread over, for a merge; 0: as --shard says
    std::vector<fs::path> merge_from;
};

// The description with what the command line leaves of it.
Description read(const ExperimentOptions& options) {
    Description description = experiment::read_description(options.description);
    std::vector<std::string> names;
    for (experiment::TableSpec& table : description.tables) {
        names.push_back(table.name);
        if (options.seeds == 0) continue;
        const std::uint64_t first = table.seeds.front();
        table.seeds.resize(static_cast<std::size_t>(options.seeds));
        std::iota(table.seeds.begin(), table.seeds.end(), first);
    }
    for (const std::string& name : options.only) {
        if (std::find(names.begin(), names.end(), name) == names.end()) {
            throw BadUse("--only " + name + ": there is no such table; did you mean " + nearest_word(name, names) +
                         "?");
        }
    }
    if (!options.only.empty()) {
        std::erase_if(description.tables, [&](const experiment::TableSpec& table) {
            return std::find(options.only.begin(), options.only.end(), table.name) == options.only.end();
        });
    }
    experiment::check(description);
    return description;
}

int list_cells(const std::vector<Unit>& units, const fs::path& out, int num_shards) {
    std::string text;
    int open = 0;
    for (std::size_t u = 0; u < units.size(); ++u) {
        for (const experiment::Cell& cell : units[u].cells) {
            const bool done = experiment::finished_cell(out, cell.key, cell.settings).has_value();
            open += done ? 0 : 1;
            text += (done ? "done  " : "open  ") + cell.key.table + "/" + cell.key.row + "/" +
                    std::to_string(cell.key.seed) + "  shard " + std::to_string(experiment::shard_of(u, num_shards)) +
                    "\n";
        }
    }
    print(text + std::to_string(open) + " cells are open\n");
    return kSuccess;
}

// <table>-<n>.png of every set with a curve; the names, empty where there is none.
std::vector<std::string> write_pictures(const tables::Results& results, const fs::path& out) {
    std::vector<std::string> names;
    for (const tables::Table& table : results.tables) {
        int number = 0;
        for (const tables::CurveSet& set : table.curve_sets) {
            const std::string name = table.name + "-" + std::to_string(++number) + ".png";
            const bool shows = std::any_of(set.curves.begin(), set.curves.end(),
                                           [](const evaluation::Curve& curve) { return !curve.bins.empty(); });
            names.push_back(shows ? name : "");
            if (!shows) continue;
            pictures::write_curve_plots(out / name,
                                        {{set.title, set.x_title, set.y_title, set.x_logarithmic, set.curves}});
        }
    }
    return names;
}

void write_all(const Description& description, const std::vector<Unit>& units, const fs::path& out,
               const SharedOptions& shared) {
    const tables::Results results = experiment::results_of(description, out);
    tables::write_results(out / "results.json", results);
    data_set::write_file_atomically(out / "results.csv", tables::csv_of(results));
    data_set::write_file_atomically(out / "results.md", tables::markdown_of(results, write_pictures(results, out)));
    const std::string versions = experiment::other_versions(units, out);
    if (!versions.empty()) {
        print_notice(
            "some cells were made by another version of the program (" + versions + "); --again makes all of them anew",
            shared.quiet);
    }
    print_notice("results are in " + (out / "results.md").string() + ", results.json and results.csv", shared.quiet);
}

// "shard 2 of 3 lacks 4 cells, shard 3 of 3 lacks 1 cell"
std::string lacking(const std::vector<int>& missing) {
    std::string text;
    for (std::size_t i = 0; i < missing.size(); ++i) {
        if (missing[i] == 0) continue;
        text += (text.empty() ? "" : ", ") + std::string("shard ") + std::to_string(i + 1) + " of " +
                std::to_string(missing.size()) + " lacks " + std::to_string(missing[i]) +
                (missing[i] == 1 ? " cell" : " cells");
    }
    return text;
}

// False where it was interrupted.
bool run_shard(const std::vector<Unit>& units, const ExperimentOptions& options, const experiment::Shard& shard,
               const SharedOptions& shared) {
    const experiment::RunOptions run{options.out, shard, options.threads, options.again};
    const std::vector<Unit> work = experiment::work_of(units, run);
    std::size_t cells = 0;
    for (const Unit& unit : work) cells += unit.cells.size();
    if (cells == 0) return true;
    std::size_t done = 0;
    {
        Progress progress("experiment", static_cast<int>(cells), shared.quiet);
        experiment::run(
            work, options.description.parent_path(), run,
            [&] {
                ++done;
                progress.step();
            },
            [] { return !interrupted(); });
    }
    if (done == cells) return true;
    print_error("interrupted after " + std::to_string(done) + " of " + std::to_string(cells) +
                " cells; the same command goes on from there");
    return false;
}

int run_experiment(const ExperimentOptions& options, const SharedOptions& shared) {
    experiment::Shard shard;
    try {
        shard = experiment::parse_shard(options.shard);
    } catch (const std::invalid_argument& error) {
        throw BadUse(std::string("--") + error.what());
    }
    const bool merge = options.merge || !options.merge_from.empty();
    if (merge && options.again) throw BadUse("--again belongs to a run: a merge runs nothing");
    if (options.shards > 0 && !merge && !options.list) throw BadUse("--shards belongs to --merge and --list");
    for (const fs::path& from : options.merge_from) {
        if (!fs::is_directory(from / "cells")) throw std::runtime_error(from.string() + ": has no folder cells");
    }
    const Description description = read(options);
    const std::vector<Unit> units = experiment::units_of(description);
    const int num_shards = options.shards > 0 ? options.shards : shard.num_shards;
    if (options.list) return list_cells(units, options.out, num_shards);
    data_set::create_folder(options.out);
    if (merge) {
        experiment::gather(units, options.merge_from, options.out);
    } else if (!run_shard(units, options, shard, shared)) {
        return kInterrupted;
    }
    const std::string missing = lacking(experiment::missing_cells(units, options.out, num_shards));
    if (missing.empty()) {
        write_all(description, units, options.out, shared);
        return kSuccess;
    }
    if (!merge) {
        print_notice("this shard is done; no results yet, for " + missing, shared.quiet);
        return kSuccess;
    }
    print_error(options.out.string() + ": no results, for " + missing);
    return kFailure;
}

void add_options(CLI::App& command, ExperimentOptions& options) {
    command.add_option("description", options.description, "What to run: FILE.json")->required();
    command.add_option("--out", options.out, "Folder of the cells and the results; a run goes on where it ended")
        ->required();
    command.add_option("--shard", options.shard, "i/n: the i-th of n parts of the work, from 1 on");
    command.add_option("--threads", options.threads, "Runs side by side; 0: as many as the machine has cores")
        ->check(CLI::Range(0, 4096));
    command.add_option("--seeds", options.seeds, "Seeds of every row, instead of the description's number")
        ->check(CLI::Range(1, 100000));
    command.add_option("--only", options.only, "Run and report this table alone; may be given several times");
    command.add_flag("--again", options.again, "Also run what is finished");
    command.add_flag("--list", options.list, "Print all cells and whether they are done, and end");
    command.add_flag("--merge", options.merge, "Run nothing: results from what is there, or who lacks what (exit 1)");
    command.add_option("--merge-from", options.merge_from,
                       "Like --merge, with the cells of another --out; may be given several times");
    command.add_option("--shards", options.shards, "For --merge and --list: how many shards there were")
        ->check(CLI::Range(1, 1000000));
}

}  // namespace

void add_experiment_command(CLI::App& app, const SharedOptions& shared, Run& run) {
    auto options = std::make_shared<ExperimentOptions>();
    CLI::App* command = app.add_subcommand("experiment", "A grid of simulated runs, with tables and curves");
    command->footer(
        "A cell is one row of a table with one seed. Finished cells are not run again unless their settings have\n"
        "changed. Shards may share one --out or be brought together by --merge-from; results are the same.");
    add_options(*command, *options);
    command->callback(
        [options, &shared, &run] { run = [options, &shared] { return run_experiment(*options, shared); }; });
}

}  // namespace nearpose::program
