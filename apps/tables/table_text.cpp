#include "apps/tables/table_text.hpp"

#include <algorithm>

#include "apps/base/number_text.hpp"

namespace nearpose::tables {
namespace {

constexpr std::size_t kTextWidth = 100;  // [letters]

std::string to_right(const std::string& text, std::size_t width) {
    return std::string(width > text.size() ? width - text.size() : 0, ' ') + text;
}

std::string to_left(const std::string& text, std::size_t width) {
    return text + std::string(width > text.size() ? width - text.size() : 0, ' ');
}

std::string title_of(const Column& column) {
    return column.unit.empty() ? column.title : column.title + " [" + column.unit + "]";
}

std::string value_of(const Entry& entry, int decimals) {
    return entry.value ? data_set::format_fixed(*entry.value, decimals) : "-";
}

std::string wrapped(const std::string& text) {
    std::string lines, line;
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = std::min(text.find(' ', begin), text.size());
        const std::string word = text.substr(begin, end - begin);
        if (!line.empty() && line.size() + 1 + word.size() > kTextWidth) {
            lines += line + "\n";
            line.clear();
        }
        line += (line.empty() ? "" : " ") + word;
        begin = end + 1;
    }
    return lines + line + (line.empty() ? "" : "\n");
}

}  // namespace

std::string text_of(const Table& table) {
    std::size_t label_width = 0;
    for (const Row& row : table.rows) label_width = std::max(label_width, row.label.size());
    std::string text = table.title + "\n" + wrapped(table.text) + "\n" + to_left("", label_width) + "  runs";
    for (const Column& column : table.columns) text += "  " + title_of(column);
    text += "\n";
    for (const Row& row : table.rows) {
        text += to_left(row.label, label_width) + to_right(std::to_string(row.runs), 6);
        for (std::size_t k = 0; k < table.columns.size() && k < row.entries.size(); ++k) {
            const Column& column = table.columns[k];
            text += "  " + to_right(value_of(row.entries[k], column.decimals), title_of(column).size());
        }
        text += "\n";
    }
    return text;
}

}  // namespace nearpose::tables
