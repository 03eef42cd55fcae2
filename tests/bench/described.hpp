// How a benchmark tells the table what it is (see table.cpp): words of its label.
//   unit=WORD        what one of its units is: a view, a solve, a frame
//   naive=NAME       the benchmark that does the same naively; the table shows how many times as long that takes
//   bare=NAME        the benchmark of the bare library calls; the table shows how many times as long this one takes:
//   its
//                    counter bare_ratio where it has measured that itself
//   naive_least=X, bare_most=X, exponent_most=X, memory_most=X    goals of the ratios, of the group's exponent, of the
//                    peak memory [MB]
#pragma once

#include <benchmark/benchmark.h>

#include <ctime>
#include <string>

namespace nearpose::bench {

// `units` is how many units one iteration does.
inline void describe(benchmark::State& state, double units, const std::string& label) {
    state.counters["units"] = units;
    state.SetLabel(label);
}

// CPU time of all threads so far [s].
inline double process_cpu_s() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace nearpose::bench
