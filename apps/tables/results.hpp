// What an experiment found: tables and curves, whatever they are of. Written as results.json, from which the Markdown
// text and the report are made.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/error_measures/curve.hpp"

namespace nearpose::tables {

struct Column {
    std::string title;
    std::string unit;  // "mm", "deg", "%", "ms", "frames", ""
    int decimals = 2;
};

// A number in a table, with its 95 % confidence interval where it has one; without a value: not known.
struct Entry {
    std::optional<double> value, low, high;
};

struct Row {
    std::string label;
    int runs = 0;
    std::vector<Entry> entries;  // parallel to the columns
};

struct CurveSet {
    std::string title, x_title, y_title;
    bool x_logarithmic = false;
    std::vector<evaluation::Curve> curves;
};

struct Table {
    std::string name;  // of the table in the description
    std::string title;
    std::string text;  // what is shown, a paragraph
    std::vector<Column> columns;
    std::vector<Row> rows;
    std::vector<CurveSet> curve_sets;
};

struct Results {
    std::string name;     // of the experiment
    std::string command;  // that makes it
    std::vector<Table> tables;
};

// JSON with "format": 1; fields named as here. Reading throws std::runtime_error naming file and key.
void write_results(const std::filesystem::path& path, const Results& results);
Results read_results(const std::filesystem::path& path);

}  // namespace nearpose::tables
