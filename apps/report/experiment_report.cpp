#include "apps/report/experiment_report.hpp"

#include <nlohmann/json.hpp>

#include "apps/tables/results.hpp"

namespace nearpose::report {
namespace {

using Json = nlohmann::ordered_json;

Json number_json(const std::optional<double>& number) {
    return number ? Json(*number) : Json(nullptr);
}

// Columns of numbers, as plots take them.
Json curve_json(const evaluation::Curve& curve) {
    Json x = Json::array(), median = x, low = x, high = x, top = x, count = x;
    for (const evaluation::CurveBin& bin : curve.bins) {
        x.push_back(bin.x);
        median.push_back(bin.median);
        low.push_back(bin.percentile_25);
        high.push_back(bin.percentile_75);
        top.push_back(bin.percentile_95);
        count.push_back(bin.count);
    }
    return {
        {"label", curve.label}, {"x", x},        {"median", median}, {"percentile_25", low}, {"percentile_75", high},
        {"percentile_95", top}, {"count", count}};
}

Json table_json(const tables::Table& table) {
    Json columns = Json::array(), rows = Json::array(), sets = Json::array();
    for (const tables::Column& column : table.columns) {
        columns.push_back({{"title", column.title}, {"unit", column.unit}, {"decimals", column.decimals}});
    }
    for (const tables::Row& row : table.rows) {
        Json entries = Json::array();
        for (const tables::Entry& entry : row.entries) {
            entries.push_back({number_json(entry.value), number_json(entry.low), number_json(entry.high)});
        }
        rows.push_back({{"label", row.label}, {"runs", row.runs}, {"entries", entries}});
    }
    for (const tables::CurveSet& set : table.curve_sets) {
        Json curves = Json::array();
        for (const evaluation::Curve& curve : set.curves) curves.push_back(curve_json(curve));
        sets.push_back({{"title", set.title},
                        {"x_title", set.x_title},
                        {"y_title", set.y_title},
                        {"x_logarithmic", set.x_logarithmic},
                        {"curves", curves}});
    }
    return {{"name", table.name}, {"title", table.title}, {"text", table.text},
            {"columns", columns}, {"rows", rows},         {"curve_sets", sets}};
}

}  // namespace

Report experiment_report(const std::filesystem::path& results_json) {
    const tables::Results results = tables::read_results(results_json);
    Json tables = Json::array();
    for (const tables::Table& table : results.tables) tables.push_back(table_json(table));
    const Json data = {{"format", 1},
                       {"kind", "experiment"},
                       {"title", results.name},
                       {"command", results.command},
                       {"tables", tables}};
    return {results.name + " - nearpose", data.dump(-1, ' ', false, Json::error_handler_t::replace)};
}

}  // namespace nearpose::report
