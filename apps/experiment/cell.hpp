// One run of a row with one seed, and the folder in which it is kept:
//   <out>/cells/<table>/<row>/<seed>/cell.json    settings and figures; written last, so that without it nothing is
//   done <out>/cells/<table>/<row>/<seed>/frames.csv   errors of every frame, of a run
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/error_measures/frame_errors.hpp"
#include "apps/experiment/column.hpp"
#include "apps/experiment/setting.hpp"

namespace nearpose::experiment {

struct CellResult {
    Figures figures;  // the same in every run
    Figures time;     // what depends on the machine
    std::vector<evaluation::FrameErrors> frames;
};

struct CellKey {
    std::string table, row;
    std::uint64_t seed = 1;
};

std::filesystem::path cell_folder(const std::filesystem::path& out, const CellKey& key);

// Throws std::runtime_error naming the file that cannot be written.
void write_cell(const std::filesystem::path& out, const CellKey& key, const Settings& settings,
                const CellResult& result);

// What a finished cell says; its frames are left in their file.
struct FinishedCell {
    std::string version;  // of the program that made it
    Figures figures;      // with those of time
};
// Nothing where there is no cell, a damaged one, or one of other settings: it is to be done (again).
std::optional<FinishedCell> finished_cell(const std::filesystem::path& out, const CellKey& key,
                                          const Settings& settings);

std::vector<evaluation::FrameErrors> read_cell_frames(const std::filesystem::path& out, const CellKey& key);

// Both files, as they are.
void copy_cell(const std::filesystem::path& from, const std::filesystem::path& to, const CellKey& key);

}  // namespace nearpose::experiment
