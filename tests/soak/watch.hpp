// What a run uses over time: its memory, and the time of an update. Halves are compared, since what grows shows there.
#pragma once

#include <vector>

namespace nearpose::soak {

struct MemorySample {
    double resident_mib = 0.0;  // of the process
    double live_mib = 0.0;      // that was allocated and not given back
};

// While no other thread allocates.
MemorySample memory_now();

struct Halves {
    double first = 0.0, second = 0.0;
    int samples = 0;  // of both

    double change() const { return first > 0.0 ? second / first - 1.0 : 0.0; }  // as a share of the first
};

// Medians of the first and of the second half.
Halves halves_of(const std::vector<double>& values);

}  // namespace nearpose::soak
