#include "tests/soak/watch.hpp"

#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>

namespace nearpose::soak {
namespace {

double median_of(std::vector<double> values) {
    if (values.empty()) return 0.0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

}  // namespace

MemorySample memory_now() {
    constexpr double kMebibyte = 1024.0 * 1024.0;
    std::ifstream file("/proc/self/statm");
    long whole_pages = 0, resident_pages = 0;
    file >> whole_pages >> resident_pages;
    const auto page_bytes = static_cast<double>(sysconf(_SC_PAGESIZE));
    const struct mallinfo2 allocated = mallinfo2();
    return {static_cast<double>(resident_pages) * page_bytes / kMebibyte,
            static_cast<double>(allocated.uordblks + allocated.hblkhd) / kMebibyte};
}

Halves halves_of(const std::vector<double>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    return {median_of({values.begin(), middle}), median_of({middle, values.end()}), static_cast<int>(values.size())};
}

}  // namespace nearpose::soak
