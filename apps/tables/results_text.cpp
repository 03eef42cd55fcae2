#include "apps/tables/results_text.hpp"

#include <algorithm>
#include <set>

#include "apps/base/number_text.hpp"

namespace nearpose::tables {
namespace {

// A bar would end the cell.
std::string in_cell(const std::string& text) {
    std::string safe;
    for (const char c : text) {
        if (c == '|') safe += '\\';
        safe += c == '\n' ? ' ' : c;
    }
    return safe;
}

std::string entry_text(const Entry& entry, int decimals) {
    const auto fixed = [&](const std::optional<double>& value) {
        return value ? data_set::format_fixed(*value, decimals) : std::string("-");
    };
    if (!entry.low && !entry.high) return fixed(entry.value);
    return fixed(entry.value) + " [" + fixed(entry.low) + ", " + fixed(entry.high) + "]";
}

std::string markdown_of(const Table& table) {
    std::string text = "## " + table.title + "\n\n";
    if (!table.text.empty()) text += table.text + "\n\n";
    std::string line = "|---|---:|";
    text += "| | runs |";
    for (const Column& column : table.columns) {
        text += " " + in_cell(column.title) + (column.unit.empty() ? "" : " [" + column.unit + "]") + " |";
        line += "---:|";
    }
    text += "\n" + line + "\n";
    for (const Row& row : table.rows) {
        text += "| " + in_cell(row.label) + " | " + std::to_string(row.runs) + " |";
        for (std::size_t c = 0; c < table.columns.size(); ++c)
            text += " " + entry_text(row.entries[c], table.columns[c].decimals) + " |";
        text += "\n";
    }
    return text + "\n";
}

// The curves' numbers: a line a bin, a column a curve; "median (95 %)".
std::string markdown_of(const CurveSet& set) {
    std::set<double> places;
    for (const evaluation::Curve& curve : set.curves) {
        for (const evaluation::CurveBin& bin : curve.bins) places.insert(bin.x);
    }
    if (places.empty()) return "";
    std::string text = "| " + in_cell(set.x_title) + " |", line = "|---:|";
    for (const evaluation::Curve& curve : set.curves) {
        text += " " + in_cell(curve.label) + " |";
        line += "---:|";
    }
    text += "\n" + line + "\n";
    for (const double x : places) {
        text += "| " + data_set::format_fixed(x, 0) + " |";
        for (const evaluation::Curve& curve : set.curves) {
            const auto bin =
                std::find_if(curve.bins.begin(), curve.bins.end(), [&](const auto& b) { return b.x == x; });
            text += bin == curve.bins.end() ? " - |"
                                            : " " + data_set::format_fixed(bin->median, 2) + " (" +
                                                  data_set::format_fixed(bin->percentile_95, 2) + ") |";
        }
        text += "\n";
    }
    return "The " + set.y_title + ", median (95 %) of the frames:\n\n" + text + "\n";
}

// Quoted, with quotes doubled, where the text would end the field.
std::string csv_field(const std::string& text) {
    if (text.find_first_of(",\"\n\r") == text.npos) return text;
    std::string quoted = "\"";
    for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
    return quoted + "\"";
}

std::string csv_number(const std::optional<double>& value) {
    return value ? data_set::format_number(*value) : "";
}

}  // namespace

std::string markdown_of(const Results& results, const std::vector<std::string>& pictures) {
    std::string text = "# " + results.name + "\n\nMade by `" + results.command +
                       "`. In brackets: the 95 % confidence interval over runs.\n\n";
    std::size_t picture = 0;
    for (const Table& table : results.tables) {
        text += markdown_of(table);
        for (const CurveSet& set : table.curve_sets) {
            if (!pictures[picture].empty()) text += "![" + set.title + "](" + pictures[picture] + ")\n\n";
            text += markdown_of(set);
            ++picture;
        }
    }
    return text;
}

std::string csv_of(const Results& results) {
    std::string text = "table,row,runs,column,unit,value,low,high\n";
    for (const Table& table : results.tables) {
        for (const Row& row : table.rows) {
            for (std::size_t c = 0; c < table.columns.size(); ++c) {
                const Column& column = table.columns[c];
                const Entry& entry = row.entries[c];
                text += csv_field(table.name) + "," + csv_field(row.label) + "," + std::to_string(row.runs) + "," +
                        csv_field(column.title) + "," + column.unit + "," + csv_number(entry.value) + "," +
                        csv_number(entry.low) + "," + csv_number(entry.high) + "\n";
            }
        }
    }
    return text;
}

}  // namespace nearpose::tables
