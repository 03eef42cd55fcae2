// How a benchmark tells the table what it is (see table.cpp): words of its label.
//   unit=WORD        what one of its units is: a view, a solve, a frame
//   naive=NAME       the benchmark that does the same naively; the table shows how many times as long that takes
//   bare=NAME        the benchmark of the bare library calls; the table shows how many times as long this one takes
//   naive_least=X, bare_most=X, exponent_most=X, memory_most=X    goals of the ratios, of the group's exponent, of the
//                    peak memory [MB]
#pragma once

#include <benchmark/benchmark.h>

#include <string>

namespace nearpose::bench {

// `units` is how many units one iteration does.
inline void describe(benchmark::State& state, double units, const std::string& label) {
    state.counters["units"] = units;
    state.SetLabel(label);
}

}  // namespace nearpose::bench
