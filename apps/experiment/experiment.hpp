// Running a description and gathering what it found.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "apps/experiment/cell.hpp"
#include "apps/experiment/description.hpp"
#include "apps/tables/results.hpp"

namespace nearpose::experiment {

struct Cell {
    CellKey key;
    TableKind kind = TableKind::kRun;
    Settings settings;
};

// What is done in one piece, by one thread and one shard: the cells of one recording, from all tables, or one cell of
// views.
struct Unit {
    std::vector<Cell> cells;
};

// In an order that depends on the description alone.
std::vector<Unit> units_of(const Description& description);

// The share of one of several runs, which may be on different machines: every num_shards-th unit from `shard` (1 to
// num_shards) on.
struct Shard {
    int shard = 1, num_shards = 1;
};
Shard parse_shard(const std::string& text);  // "2/5"; throws std::invalid_argument
int shard_of(std::size_t unit, int num_shards);

struct RunOptions {
    std::filesystem::path out;
    Shard shard;
    int num_threads = 0;  // 0: as many as the machine has
    bool again = false;   // also what is finished
};

// Those of a shard that are not finished (or all, with `again`), in units.
std::vector<Unit> work_of(const std::vector<Unit>& units, const RunOptions& options);

// Does the work: units side by side, each cell written as soon as its unit is through. `cell_done` is called once a
// cell, never twice at the same time; `go_on` once a frame from any thread, and when it says no, units that are not
// through leave nothing behind. An error ends the run after the units in hand.
void run(const std::vector<Unit>& work, const std::filesystem::path& folder_of_description, const RunOptions& options,
         const std::function<void()>& cell_done, const std::function<bool()>& go_on);

// Copies finished cells that `out` lacks.
void gather(const std::vector<Unit>& units, const std::vector<std::filesystem::path>& from,
            const std::filesystem::path& out);

// Cells that are not finished, by shard (index 0 is shard 1).
std::vector<int> missing_cells(const std::vector<Unit>& units, const std::filesystem::path& out, int num_shards);

// Tables and curves of all cells, which must be finished. Their figures decide alone, not who made them when.
tables::Results results_of(const Description& description, const std::filesystem::path& out);

// Other versions of the program that cells were made with, "0.1.0, 0.2.0"; empty where all are of this one.
std::string other_versions(const std::vector<Unit>& units, const std::filesystem::path& out);

}  // namespace nearpose::experiment
