#include "apps/experiment/description.hpp"

#include <algorithm>
#include <cctype>
#include <set>

#include "apps/base/nearest_word.hpp"
#include "apps/experiment/column.hpp"

namespace nearpose::experiment {
namespace {

using data_set::JsonValue;

constexpr std::size_t kMaxRows = 10'000;  // of a table
constexpr int kMaxSeeds = 100'000;

std::string text_or_empty(const JsonValue& object, const char* key) {
    const auto value = object.find(key);
    return value ? value->text() : std::string();
}

void refuse_unknown(const JsonValue& object, const std::vector<std::string>& known) {
    for (const auto& [key, value] : object.members()) {
        if (std::find(known.begin(), known.end(), key) == known.end()) {
            throw value.error("is not known; did you mean " + program::nearest_word(key, known) + "?");
        }
    }
}

// What a word of a fixed list must be.
std::string word_of(const JsonValue& value, const std::vector<std::string>& known) {
    const std::string word = value.text();
    if (std::find(known.begin(), known.end(), word) == known.end()) {
        throw value.error("is " + word + "; did you mean " + program::nearest_word(word, known) + "?");
    }
    return word;
}

std::vector<std::string> read_columns(TableKind kind, const JsonValue& list) {
    std::vector<std::string> columns;
    for (const JsonValue& value : list.elements()) columns.push_back(word_of(value, column_names(kind)));
    if (columns.empty()) throw list.error("is empty");
    return columns;
}

std::vector<std::uint64_t> read_seeds(const JsonValue& value) {
    int first = 1, count = 0;
    if (value.is_number()) {
        count = value.integer();
    } else {
        refuse_unknown(value, {"first", "count"});
        first = value.at("first").integer();
        count = value.at("count").integer();
    }
    if (count < 1 || count > kMaxSeeds || first < 0) {
        throw value.error("must be from 1 to " + std::to_string(kMaxSeeds) + " seeds, from 0 on");
    }
    std::vector<std::uint64_t> seeds;
    for (int i = 0; i < count; ++i) seeds.push_back(static_cast<std::uint64_t>(first) + static_cast<unsigned>(i));
    return seeds;
}

CurveSpec read_curve(const JsonValue& value) {
    refuse_unknown(value, {"x", "y", "bins", "low", "high", "logarithmic", "burn_in"});
    CurveSpec curve;
    curve.x = word_of(value.at("x"), {"distance", "visible_volume", "visible_fraction"});
    curve.y = word_of(value.at("y"), {"translation", "rotation"});
    if (const auto bins = value.find("bins")) curve.bins = bins->integer();
    if (curve.bins < 1 || curve.bins > 1000) throw value.at("bins").error("must be in 1..1000");
    curve.low = value.at("low").number();
    curve.high = value.at("high").number();
    if (!(curve.low < curve.high)) throw value.at("high").error("must be larger than low");
    if (const auto burn_in = value.find("burn_in")) curve.burn_in = burn_in->integer();
    if (curve.burn_in.value_or(0) < 0) throw value.at("burn_in").error("must not be negative");
    if (const auto logarithmic = value.find("logarithmic")) curve.logarithmic = logarithmic->flag();
    if (curve.logarithmic && !(curve.low > 0.0)) throw value.at("low").error("must be positive for logarithmic bins");
    return curve;
}

// The settings of an object, each with the values that it is to take.
using Choices = std::map<std::string, std::vector<Value>>;

Choices read_choices(TableKind kind, const JsonValue& object) {
    Choices choices;
    for (const auto& [name, value] : object.members()) {
        if (name == "label") continue;
        const SettingRule& rule = rule_of(kind, name, value);
        std::vector<Value>& values = choices[name];
        if (value.is_array()) {
            for (const JsonValue& element : value.elements()) values.push_back(read_value(rule, element));
        } else {
            values.push_back(read_value(rule, value));
        }
        if (values.empty()) throw value.error("is an empty list");
    }
    return choices;
}

// What is told first of a run varies slowest: its scenario.
std::vector<std::string> in_order(TableKind kind) {
    std::vector<std::string> names;
    for (const SettingRule& rule : setting_rules()) {
        if (rule.kind == kind) names.push_back(rule.name);
    }
    return names;
}

std::vector<Settings> product_of(TableKind kind, const Choices& choices, const JsonValue& object) {
    std::vector<Settings> rows = {Settings{}};
    for (const std::string& name : in_order(kind)) {
        const auto choice = choices.find(name);
        if (choice == choices.end()) continue;
        const std::vector<Value>& values = choice->second;
        if (rows.size() * values.size() > kMaxRows) throw object.error("stands for too many rows");
        std::vector<Settings> longer;
        for (const Settings& row : rows) {
            for (const Value& value : values) {
                longer.push_back(row);
                longer.back()[name] = value;
            }
        }
        rows = std::move(longer);
    }
    return rows;
}

// A row before it has a label: what its object and the lists of "with" set, and which of it varies in the object.
struct OpenRow {
    std::string label;
    Settings own;
    std::set<std::string> varying;
};

std::vector<OpenRow> read_row(TableKind kind, const JsonValue& object, const Choices& with) {
    Choices choices = read_choices(kind, object);
    for (const auto& [name, values] : with) {
        if (values.size() > 1) choices.emplace(name, values);  // a row's own values take the place of the common ones
    }
    std::vector<OpenRow> rows;
    for (Settings& own : product_of(kind, choices, object)) rows.push_back({text_or_empty(object, "label"), own, {}});
    for (OpenRow& row : rows) {
        for (const auto& [name, values] : choices) {
            if (values.size() > 1) row.varying.insert(name);
        }
    }
    return rows;
}

// "paper", "rounds 2", "arm 0.5 mm".
std::string words_for(const std::string& name, const Value& value) {
    // The values of these say what they are.
    for (const char* plain : {"scenario", "part", "sensor", "method", "views"}) {
        if (name == plain) return text_of(value);
    }
    std::string words = name, unit;
    for (const char* ending : {"_mm", "_deg", "_ms"}) {
        if (!name.ends_with(ending)) continue;
        words = name.substr(0, name.size() - std::string(ending).size());
        unit = std::string(" ") + (ending + 1);
    }
    std::replace(words.begin(), words.end(), '_', ' ');
    return words + " " + text_of(value) + unit;
}

std::string label_of(TableKind kind, const OpenRow& row, const std::set<std::string>& varying) {
    std::string label = row.label;
    for (const std::string& name : in_order(kind)) {
        const auto found = row.own.find(name);
        const bool told = row.label.empty() ? varying.count(name) != 0 : row.varying.count(name) != 0;
        if (told && found != row.own.end()) label += (label.empty() ? "" : ", ") + words_for(name, found->second);
    }
    return label.empty() ? "unchanged" : label;
}

// Settings that do not have the same value in all rows; not to be set differs from every value.
std::set<std::string> varying_in(const std::vector<OpenRow>& rows) {
    std::set<std::string> varying;
    for (const OpenRow& row : rows) {
        for (const auto& [name, value] : row.own) {
            for (const OpenRow& other : rows) {
                const auto found = other.own.find(name);
                if (found == other.own.end() || found->second != value) varying.insert(name);
            }
        }
    }
    return varying;
}

std::string folder_of(const OpenRow& row) {
    std::string text;
    for (const auto& [name, value] : row.own) text += (text.empty() ? "" : "_") + name + "-" + text_of(value);
    return slug_of(text.empty() ? "unchanged" : text);
}

std::vector<RowSpec> read_rows(TableKind kind, const JsonValue& table) {
    const auto with_value = table.find("with");
    const Choices with = with_value ? read_choices(kind, *with_value) : Choices{};
    const JsonValue list = table.at("rows");
    std::vector<OpenRow> open;
    for (const JsonValue& object : list.elements()) {
        for (OpenRow& row : read_row(kind, object, with)) open.push_back(std::move(row));
        if (open.size() > kMaxRows) throw list.error("stands for too many rows");
    }
    if (open.empty()) throw list.error("is empty");
    const std::set<std::string> varying = varying_in(open);
    std::vector<RowSpec> rows;
    std::map<std::string, std::string> label_of_slug;
    for (const OpenRow& row : open) {
        Settings settings = row.own;
        for (const auto& [name, values] : with) settings.emplace(name, values.front());
        rows.push_back({label_of(kind, row, varying), folder_of(row), completed(kind, settings)});
        const auto [other, fresh] = label_of_slug.emplace(rows.back().slug, rows.back().label);
        if (!fresh) throw list.error("two rows are the same: " + rows.back().label + " and " + other->second);
    }
    return rows;
}

TableSpec read_table(const JsonValue& value) {
    refuse_unknown(value, {"name", "title", "text", "kind", "columns", "with", "rows", "seeds", "curves"});
    TableSpec table;
    table.name = value.at("name").text();
    if (table.name.empty() || slug_of(table.name) != table.name) {
        throw value.at("name").error("must be of letters, digits, '.', '_' and '-'");
    }
    table.title = text_or_empty(value, "title");
    if (table.title.empty()) table.title = table.name;
    table.text = text_or_empty(value, "text");
    if (const auto kind = value.find("kind")) {
        table.kind = word_of(*kind, {"run", "views"}) == "run" ? TableKind::kRun : TableKind::kViews;
    }
    table.columns = read_columns(table.kind, value.at("columns"));
    table.rows = read_rows(table.kind, value);
    table.seeds = read_seeds(value.at("seeds"));
    if (const auto curves = value.find("curves")) {
        if (table.kind != TableKind::kRun)
            throw curves->error("belong to tables of the kind run: views have no frames");
        for (const JsonValue& curve : curves->elements()) table.curves.push_back(read_curve(curve));
    }
    return table;
}

}  // namespace

std::string slug_of(const std::string& text) {
    constexpr std::size_t kMaxLetters = 80, kHashLetters = 9;
    std::string slug;
    for (const char c : text) {
        const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
                           c == '-' || (c == '.' && !slug.empty());
        slug += plain ? c : '-';
    }
    if (slug == text && slug.size() <= kMaxLetters) return slug;
    std::uint64_t hash = 14695981039346656037U;  // FNV-1a
    for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211U;
    slug.resize(std::min(slug.size(), kMaxLetters - kHashLetters));
    slug += "-";
    for (int i = 0; i < 8; ++i) slug += "0123456789abcdef"[hash >> (4 * i) & 15U];
    return slug;
}

Description read_description(const std::filesystem::path& file) {
    const data_set::JsonFile json(file);
    const JsonValue root = json.root();
    refuse_unknown(root, {"format", "name", "tables"});
    if (root.at("format").integer() != 1) throw root.at("format").error("is not 1, the only one that is known");
    Description description{file, root.at("name").text(), {}};
    std::set<std::string> names;
    for (const JsonValue& value : root.at("tables").elements()) {
        description.tables.push_back(read_table(value));
        if (!names.insert(description.tables.back().name).second) throw value.at("name").error("stands twice");
    }
    if (description.tables.empty()) throw root.at("tables").error("is empty");
    return description;
}

}  // namespace nearpose::experiment
