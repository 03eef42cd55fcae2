#include "apps/experiment/cell.hpp"

#include "apps/base/file_io.hpp"
#include "apps/base/number_text.hpp"
#include "apps/base/version.hpp"
#include "apps/data_set/json_file.hpp"

namespace nearpose::experiment {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMaxTableBytes = std::uintmax_t{1} << 30;

std::string json_of_figures(const Figures& figures) {
    std::string text;
    for (const auto& [name, value] : figures) {
        text += (text.empty() ? "" : ",\n  ") + data_set::json_string(name) + ": " + data_set::format_number(value);
    }
    return "{" + text + "}";
}

void read_figures(const data_set::JsonValue& value, Figures& figures) {
    for (const auto& [name, number] : value.members()) figures[name] = number.number();
}

}  // namespace

fs::path cell_folder(const fs::path& out, const CellKey& key) {
    return out / "cells" / key.table / key.row / std::to_string(key.seed);
}

void write_cell(const fs::path& out, const CellKey& key, const Settings& settings, const CellResult& result) {
    const fs::path folder = cell_folder(out, key);
    data_set::create_folder(folder);
    fs::remove(folder / "cell.json");  // an older one must not speak for the new frames
    if (!result.frames.empty())
        data_set::write_file_atomically(folder / "frames.csv", evaluation::table_of(result.frames));
    std::string text = "{\"format\": 1,\n \"version\": " + data_set::json_string(program::version_number());
    text += ",\n \"table\": " + data_set::json_string(key.table) + ",\n \"row\": " + data_set::json_string(key.row);
    text += ",\n \"seed\": " + std::to_string(key.seed) + ",\n \"settings\": " + json_of(settings);
    text += ",\n \"frames\": " + std::to_string(result.frames.size());
    text += ",\n \"figures\": " + json_of_figures(result.figures);
    text += ",\n \"time\": " + json_of_figures(result.time) + "}\n";
    data_set::write_file_atomically(folder / "cell.json", text);
}

std::optional<FinishedCell> finished_cell(const fs::path& out, const CellKey& key, const Settings& settings) {
    const fs::path folder = cell_folder(out, key);
    std::error_code error;
    if (!fs::exists(folder / "cell.json", error)) return std::nullopt;
    try {
        const data_set::JsonFile file(folder / "cell.json");
        const data_set::JsonValue root = file.root();
        if (root.at("format").integer() != 1) return std::nullopt;
        if (settings_from_json(root.at("settings")) != settings) return std::nullopt;
        if (root.at("frames").integer() > 0 && !fs::exists(folder / "frames.csv")) return std::nullopt;
        FinishedCell cell{root.at("version").text(), {}};
        read_figures(root.at("figures"), cell.figures);
        read_figures(root.at("time"), cell.figures);
        return cell;
    } catch (const std::runtime_error&) {
        return std::nullopt;  // cut short by hand or by a broken disk
    }
}

std::vector<evaluation::FrameErrors> read_cell_frames(const fs::path& out, const CellKey& key) {
    return evaluation::read_table(cell_folder(out, key) / "frames.csv");
}

void copy_cell(const fs::path& from, const fs::path& to, const CellKey& key) {
    const fs::path source = cell_folder(from, key), target = cell_folder(to, key);
    data_set::create_folder(target);
    fs::remove(target / "cell.json");
    for (const char* name : {"frames.csv", "cell.json"}) {
        if (!fs::exists(source / name)) continue;
        data_set::write_file_atomically(target / name, data_set::read_whole_file(source / name, kMaxTableBytes));
    }
}

}  // namespace nearpose::experiment
