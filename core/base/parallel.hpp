// The one parallel loop.
#pragma once

#include <functional>

namespace nearpose {

// Calls work(0) ... work(count - 1), each once, on `num_threads` threads (0: as many as the machine has). Call i may
// write nothing that another call reads, so results do not depend on the number of threads. If calls throw, the
// exception of the lowest index is thrown after all have ended.
//
// In a child process forked after a parallel region the loop runs serially: the OpenMP runtime of GCC hangs there.
void parallel_for(int count, int num_threads, const std::function<void(int)>& work);

}  // namespace nearpose
