// Time that a thread has really worked.
#pragma once

#include <time.h>

namespace nearpose {

// CPU time of the calling thread so far [s].
inline double thread_cpu_s() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace nearpose
