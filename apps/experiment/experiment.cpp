#include "apps/experiment/experiment.hpp"

#include <atomic>
#include <map>
#include <mutex>
#include <set>
#include <stdexcept>

#include "apps/base/number_text.hpp"
#include "apps/base/text_split.hpp"
#include "apps/base/version.hpp"
#include "apps/experiment/run_cells.hpp"
#include "apps/experiment/run_setup.hpp"
#include "core/base/parallel.hpp"

namespace nearpose::experiment {
namespace {

namespace fs = std::filesystem;

// Cells of one unit have the same.
std::string unit_key(const Cell& cell, std::size_t number) {
    if (cell.kind == TableKind::kViews) return "views " + std::to_string(number);
    return json_of(used_for(cell.kind, SettingUse::kRecording, cell.settings)) + std::to_string(cell.key.seed);
}

std::vector<CellResult> results_of_unit(const Unit& unit, Workshop& workshop, const std::function<bool()>& go_on) {
    const Cell& first = unit.cells.front();
    if (first.kind == TableKind::kViews) {
        if (!go_on()) return {};
        return {run_views(first.settings, first.key.seed, workshop)};
    }
    std::vector<Settings> settings;
    for (const Cell& cell : unit.cells) settings.push_back(cell.settings);
    return run_recording(settings, first.key.seed, workshop, go_on);
}

}  // namespace

std::vector<Unit> units_of(const Description& description) {
    std::vector<Unit> units;
    std::map<std::string, std::size_t> unit_of_key;
    std::size_t number = 0;
    for (const TableSpec& table : description.tables) {
        for (const RowSpec& row : table.rows) {
            for (const std::uint64_t seed : table.seeds) {
                Cell cell{{table.name, row.slug, seed}, table.kind, row.settings};
                const auto [place, fresh] = unit_of_key.emplace(unit_key(cell, number++), units.size());
                if (fresh) units.emplace_back();
                units[place->second].cells.push_back(std::move(cell));
            }
        }
    }
    return units;
}

Shard parse_shard(const std::string& text) {
    const std::vector<std::string_view> parts = data_set::split(text, '/');
    const auto shard = parts.size() == 2 ? data_set::parse_integer(parts[0]) : std::nullopt;
    const auto count = parts.size() == 2 ? data_set::parse_integer(parts[1]) : std::nullopt;
    if (!shard || !count || *count < 1 || *count > 1'000'000 || *shard < 1 || *shard > *count) {
        throw std::invalid_argument("shard " + text + ": must be i/n with i from 1 to n");
    }
    return {static_cast<int>(*shard), static_cast<int>(*count)};
}

int shard_of(std::size_t unit, int num_shards) {
    return static_cast<int>(unit % static_cast<std::size_t>(num_shards)) + 1;
}

std::vector<Unit> work_of(const std::vector<Unit>& units, const RunOptions& options) {
    std::vector<Unit> work;
    for (std::size_t u = 0; u < units.size(); ++u) {
        if (shard_of(u, options.shard.num_shards) != options.shard.shard) continue;
        Unit open;
        for (const Cell& cell : units[u].cells) {
            if (options.again || !finished_cell(options.out, cell.key, cell.settings)) open.cells.push_back(cell);
        }
        if (!open.cells.empty()) work.push_back(std::move(open));
    }
    return work;
}

void run(const std::vector<Unit>& work, const fs::path& folder_of_description, const RunOptions& options,
         const std::function<void()>& cell_done, const std::function<bool()>& go_on) {
    Workshop workshop(folder_of_description);
    std::atomic<bool> failed = false;
    std::mutex mutex;
    const auto keep_going = [&] { return !failed && go_on(); };
    parallel_for(static_cast<int>(work.size()), options.num_threads, [&](int i) {
        if (!keep_going()) return;
        const Unit& unit = work[static_cast<std::size_t>(i)];
        try {
            const std::vector<CellResult> results = results_of_unit(unit, workshop, keep_going);
            for (std::size_t k = 0; k < results.size(); ++k) {
                write_cell(options.out, unit.cells[k].key, unit.cells[k].settings, results[k]);
                const std::lock_guard lock(mutex);
                cell_done();
            }
        } catch (const std::exception& error) {
            failed = true;
            const CellKey& key = unit.cells.front().key;
            throw std::runtime_error("table " + key.table + ", row " + key.row + ", seed " + std::to_string(key.seed) +
                                     ": " + error.what());
        }
    });
}

void gather(const std::vector<Unit>& units, const std::vector<fs::path>& from, const fs::path& out) {
    for (const Unit& unit : units) {
        for (const Cell& cell : unit.cells) {
            for (const fs::path& source : from) {
                if (finished_cell(out, cell.key, cell.settings)) break;
                if (finished_cell(source, cell.key, cell.settings)) copy_cell(source, out, cell.key);
            }
        }
    }
}

std::vector<int> missing_cells(const std::vector<Unit>& units, const fs::path& out, int num_shards) {
    std::vector<int> missing(static_cast<std::size_t>(num_shards), 0);
    for (std::size_t u = 0; u < units.size(); ++u) {
        for (const Cell& cell : units[u].cells) {
            if (!finished_cell(out, cell.key, cell.settings))
                ++missing[static_cast<std::size_t>(shard_of(u, num_shards) - 1)];
        }
    }
    return missing;
}

std::string other_versions(const std::vector<Unit>& units, const fs::path& out) {
    std::set<std::string> versions;
    for (const Unit& unit : units) {
        for (const Cell& cell : unit.cells) {
            if (const auto finished = finished_cell(out, cell.key, cell.settings)) versions.insert(finished->version);
        }
    }
    versions.erase(program::version_number());
    std::string text;
    for (const std::string& version : versions) text += (text.empty() ? "" : ", ") + version;
    return text;
}

}  // namespace nearpose::experiment
