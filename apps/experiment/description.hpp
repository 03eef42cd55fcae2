// What an experiment is to do: FILE.json.
//
//   {"format": 1, "name": "...", "tables": [{
//      "name": "paper",                      also the name of a folder
//      "title": "...", "text": "...",        optional
//      "kind": "run",                        or "views"
//      "columns": ["translation_mean", ...], see column.hpp
//      "with": {"particles": 100, ...},      settings of all rows, see setting.hpp
//      "rows": [{"label": "...", "scenario": ["baseline", "piston"], "rounds": 3}, ...],
//      "seeds": 20,                          or {"first": 1, "count": 20}
//      "curves": [{"x": "distance", "y": "translation", "bins": 20, "low": 100, "high": 600, "logarithmic": false,
//                  "burn_in": 0}]
//   }]}
//
// Every setting may be a list; a row object stands for the product of its lists and those of "with", in the order of
// setting_rules(), of which the last varies fastest. Paths are relative to the description's folder. A row without a
// label is called by what varies in the table.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/experiment/setting.hpp"

namespace nearpose::experiment {

// Errors of all frames after the burn-in against something, a curve a row.
struct CurveSpec {
    std::string x;  // distance [mm], visible_volume [cm^3], visible_fraction [%]
    std::string y;  // translation [mm], rotation [deg]
    int bins = 20;
    double low = 0.0, high = 0.0;  // of x
    bool logarithmic = false;
    std::optional<int> burn_in;  // frames left out at the start; none: as the row's other figures
};

struct RowSpec {
    std::string label;
    std::string slug;   // a folder's name, unique in its table; of the row's own settings, not of its place
    Settings settings;  // all, with what is usual
};

struct TableSpec {
    std::string name, title, text;
    TableKind kind = TableKind::kRun;
    std::vector<std::string> columns;
    std::vector<RowSpec> rows;
    std::vector<std::uint64_t> seeds;
    std::vector<CurveSpec> curves;
};

struct Description {
    std::filesystem::path file;
    std::string name;
    std::vector<TableSpec> tables;
};

// Throws std::runtime_error naming file, table, row and key; what settings mean together is checked by run_setup.hpp.
Description read_description(const std::filesystem::path& file);

// Letters, digits, '.', '_' and '-' alone, at most 80; where that changes `text`, with a number made of it, so that
// different texts stay different.
std::string slug_of(const std::string& text);

}  // namespace nearpose::experiment
