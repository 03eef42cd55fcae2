#include <atomic>
#include <mutex>

#include "apps/compare/filter_table.hpp"
#include "apps/data_set/file_io.hpp"
#include "core/parallel.hpp"

namespace nearpose::compare {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMaxSettingsBytes = 1 << 16;

fs::path run_file(const fs::path& folder, const ComparedFilter& filter, std::uint64_t seed) {
    return folder / (filter.method + "_" + filter.views + "_" + std::to_string(filter.particles) + "_seed_" +
                     std::to_string(seed) + ".csv");
}

// The folder's first run says what all of them are made with.
void claim_folder(const fs::path& folder, const std::string& settings) {
    data_set::create_folder(folder);
    const fs::path file = folder / "settings.txt";
    if (!fs::exists(file)) {
        data_set::write_file_atomically(file, settings);
    } else if (data_set::read_whole_file(file, kMaxSettingsBytes) != settings) {
        throw std::runtime_error(file.string() +
                                 ": the runs there were made with other settings; take another --out, or remove it");
    }
}

// Frames of one seed for all filters, from the folder where it has them all.
bool read_runs(const fs::path& folder, const std::vector<ComparedFilter>& filters, std::uint64_t seed,
               FilterResults& results) {
    for (const ComparedFilter& filter : filters) {
        if (folder.empty() || !fs::exists(run_file(folder, filter, seed))) return false;
    }
    for (std::size_t k = 0; k < filters.size(); ++k) {
        results[k][static_cast<std::size_t>(seed - 1)] = evaluation::read_table(run_file(folder, filters[k], seed));
    }
    return true;
}

}  // namespace

FilterResults filter_results(const std::vector<ComparedFilter>& filters,
                             const std::function<FilterRecording(std::uint64_t)>& recording_of,
                             const FilterTableOptions& options, const std::function<bool()>& go_on,
                             const std::function<void()>& run_done) {
    if (!options.folder.empty()) claim_folder(options.folder, options.settings);
    const auto num_seeds = static_cast<std::size_t>(options.seeds);
    FilterResults results(filters.size(), std::vector<std::vector<evaluation::FrameErrors>>(num_seeds));
    std::atomic<bool> stopped = false;
    std::mutex mutex;
    parallel_for(options.seeds, options.num_threads, [&](int i) {
        const auto seed = static_cast<std::uint64_t>(i) + 1;
        if (stopped) return;
        if (!read_runs(options.folder, filters, seed, results)) {
            const auto runs = run_filters(recording_of(seed), filters, seed, [&] { return !stopped && go_on(); });
            if (runs.empty()) {
                stopped = true;
                return;
            }
            for (std::size_t k = 0; k < filters.size(); ++k) {
                results[k][static_cast<std::size_t>(i)] = runs[k];
                if (options.folder.empty()) continue;
                data_set::write_file_atomically(run_file(options.folder, filters[k], seed),
                                                evaluation::table_of(runs[k]));
            }
            // As a later call will read them: the same tables, resumed or not.
            read_runs(options.folder, filters, seed, results);
        }
        const std::lock_guard lock(mutex);
        run_done();
    });
    if (stopped) return {};
    return results;
}

}  // namespace nearpose::compare
