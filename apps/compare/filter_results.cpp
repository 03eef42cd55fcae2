#include <atomic>
#include <mutex>

#include "apps/compare/filter_table.hpp"
#include "core/base/parallel.hpp"

namespace nearpose::compare {

FilterResults filter_results(const std::vector<ComparedFilter>& filters,
                             const std::function<FilterRecording(std::uint64_t)>& recording_of,
                             const FilterTableOptions& options, const std::function<bool()>& go_on,
                             const std::function<void()>& run_done) {
    const auto num_seeds = static_cast<std::size_t>(options.seeds);
    FilterResults results(filters.size(), std::vector<std::vector<evaluation::FrameErrors>>(num_seeds));
    std::atomic<bool> stopped = false;
    std::mutex mutex;
    parallel_for(options.seeds, options.num_threads, [&](int i) {
        if (stopped) return;
        const auto seed = static_cast<std::uint64_t>(i) + 1;
        auto runs = run_filters(recording_of(seed), filters, seed, [&] { return !stopped && go_on(); });
        if (runs.empty()) {
            stopped = true;
            return;
        }
        for (std::size_t k = 0; k < filters.size(); ++k) results[k][static_cast<std::size_t>(i)] = std::move(runs[k]);
        const std::lock_guard lock(mutex);
        run_done();
    });
    if (stopped) return {};
    return results;
}

}  // namespace nearpose::compare
