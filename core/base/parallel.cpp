#include "core/base/parallel.hpp"

#include <omp.h>
#include <unistd.h>

#include <algorithm>
#include <exception>
#include <limits>
#include <mutex>

namespace nearpose {
namespace {

// The process that first ran a parallel region owns the runtime's threads; its children have none of them.
bool threads_survive_here() {
    static const pid_t first_process = getpid();
    return getpid() == first_process;
}

}  // namespace

void parallel_for(int count, int num_threads, const std::function<void(int)>& work) {
    const int wanted = num_threads > 0 ? num_threads : omp_get_num_procs();
    const int threads = threads_survive_here() ? std::clamp(wanted, 1, std::max(1, count)) : 1;
    std::exception_ptr first_error;
    int first_index = std::numeric_limits<int>::max();
    std::mutex error_mutex;
#pragma omp parallel for schedule(dynamic, 1) num_threads(threads) if (threads > 1)
    for (int i = 0; i < count; ++i) {
        try {
            work(i);
        } catch (...) {
            const std::lock_guard lock(error_mutex);
            if (i < first_index) {
                first_index = i;
                first_error = std::current_exception();
            }
        }
    }
    if (first_error) std::rethrow_exception(first_error);
}

}  // namespace nearpose
