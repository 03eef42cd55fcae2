#include "apps/tables/results.hpp"

#include <nlohmann/json.hpp>

#include "apps/base/file_io.hpp"
#include "apps/data_set/json_file.hpp"

namespace nearpose::tables {
namespace {

using Json = nlohmann::ordered_json;
using data_set::JsonValue;

Json number_json(const std::optional<double>& number) {
    return number ? Json(*number) : Json(nullptr);
}

Json curve_json(const evaluation::Curve& curve) {
    Json bins = Json::array();
    for (const evaluation::CurveBin& bin : curve.bins) {
        bins.push_back({{"x", bin.x},
                        {"count", bin.count},
                        {"median", bin.median},
                        {"percentile_25", bin.percentile_25},
                        {"percentile_75", bin.percentile_75},
                        {"percentile_95", bin.percentile_95}});
    }
    return {{"label", curve.label}, {"bins", bins}};
}

Json curve_set_json(const CurveSet& set) {
    Json curves = Json::array();
    for (const evaluation::Curve& curve : set.curves) curves.push_back(curve_json(curve));
    return {{"title", set.title},
            {"x_title", set.x_title},
            {"y_title", set.y_title},
            {"x_logarithmic", set.x_logarithmic},
            {"curves", curves}};
}

Json table_json(const Table& table) {
    Json columns = Json::array(), rows = Json::array(), sets = Json::array();
    for (const Column& column : table.columns) {
        columns.push_back({{"title", column.title}, {"unit", column.unit}, {"decimals", column.decimals}});
    }
    for (const Row& row : table.rows) {
        Json entries = Json::array();
        for (const Entry& entry : row.entries) {
            entries.push_back({{"value", number_json(entry.value)},
                               {"low", number_json(entry.low)},
                               {"high", number_json(entry.high)}});
        }
        rows.push_back({{"label", row.label}, {"runs", row.runs}, {"entries", entries}});
    }
    for (const CurveSet& set : table.curve_sets) sets.push_back(curve_set_json(set));
    return {{"name", table.name}, {"title", table.title}, {"text", table.text},
            {"columns", columns}, {"rows", rows},         {"curve_sets", sets}};
}

std::optional<double> number_of(const JsonValue& entry, const char* key) {
    const auto value = entry.find(key);
    return value && value->is_number() ? std::optional<double>(value->number()) : std::nullopt;
}

evaluation::Curve curve_of(const JsonValue& json) {
    evaluation::Curve curve{json.at("label").text(), {}};
    for (const JsonValue& bin : json.at("bins").elements()) {
        curve.bins.push_back({bin.at("x").number(), bin.at("count").integer(), bin.at("median").number(),
                              bin.at("percentile_25").number(), bin.at("percentile_75").number(),
                              bin.at("percentile_95").number()});
    }
    return curve;
}

Row row_of(const JsonValue& json, std::size_t columns) {
    Row row{json.at("label").text(), json.at("runs").integer(), {}};
    for (const JsonValue& entry : json.at("entries").elements()) {
        row.entries.push_back({number_of(entry, "value"), number_of(entry, "low"), number_of(entry, "high")});
    }
    if (row.entries.size() != columns) throw json.at("entries").error("has not as many entries as there are columns");
    return row;
}

Table table_of(const JsonValue& json) {
    Table table{json.at("name").text(), json.at("title").text(), json.at("text").text(), {}, {}, {}};
    for (const JsonValue& column : json.at("columns").elements()) {
        table.columns.push_back({column.at("title").text(), column.at("unit").text(), column.at("decimals").integer()});
    }
    for (const JsonValue& row : json.at("rows").elements()) table.rows.push_back(row_of(row, table.columns.size()));
    for (const JsonValue& set : json.at("curve_sets").elements()) {
        CurveSet& curves = table.curve_sets.emplace_back(
            CurveSet{set.at("title").text(), set.at("x_title").text(), set.at("y_title").text(), false, {}});
        curves.x_logarithmic = set.at("x_logarithmic").flag();
        for (const JsonValue& curve : set.at("curves").elements()) curves.curves.push_back(curve_of(curve));
    }
    return table;
}

}  // namespace

void write_results(const std::filesystem::path& path, const Results& results) {
    Json tables = Json::array();
    for (const Table& table : results.tables) tables.push_back(table_json(table));
    const Json json = {{"format", 1}, {"name", results.name}, {"command", results.command}, {"tables", tables}};
    data_set::write_file_atomically(path, json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
}

Results read_results(const std::filesystem::path& path) {
    const data_set::JsonFile file(path);
    const JsonValue root = file.root();
    if (root.at("format").integer() != 1) throw root.at("format").error("is not 1, the only one that is known");
    Results results{root.at("name").text(), root.at("command").text(), {}};
    for (const JsonValue& table : root.at("tables").elements()) results.tables.push_back(table_of(table));
    return results;
}

}  // namespace nearpose::tables
