#include "tests/faults/failing_memory.hpp"

#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <new>

// The linker's --wrap=malloc leads calls of malloc from the object files of the program here; those of shared libraries
// (the C++ runtime's own for exceptions, OpenMP's) stay as they are.
extern "C" {
void* __real_malloc(std::size_t size);  // NOLINT(bugprone-reserved-identifier): the linker's name
void* __wrap_malloc(std::size_t size);  // NOLINT(bugprone-reserved-identifier)
}

namespace {

std::atomic<bool> counts = false, goes_on_failing = false;
std::atomic<long> count = 0, fails_at = 0;

bool next_fails() {
    if (!counts.load(std::memory_order_relaxed)) return false;
    const long number = count.fetch_add(1, std::memory_order_relaxed) + 1;
    const long failing = fails_at.load(std::memory_order_relaxed);
    return failing > 0 && (number == failing || (number > failing && goes_on_failing));
}

void* allocate(std::size_t size) {
    return next_fails() ? nullptr : __real_malloc(size == 0 ? 1 : size);
}

void* allocate_aligned(std::size_t size, std::align_val_t alignment) {
    const auto unit = static_cast<std::size_t>(alignment);
    return next_fails() ? nullptr : std::aligned_alloc(unit, (size + unit - 1) / unit * unit);
}

void* or_throw(void* memory) {
    if (memory == nullptr) throw std::bad_alloc();
    return memory;
}

}  // namespace

extern "C" void* __wrap_malloc(std::size_t size) {  // NOLINT(bugprone-reserved-identifier)
    return allocate(size);
}

// The forms for arrays call these.
void* operator new(std::size_t size) {
    return or_throw(allocate(size));
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
    return allocate(size);
}
void* operator new(std::size_t size, std::align_val_t alignment) {
    return or_throw(allocate_aligned(size, alignment));
}
void* operator new(std::size_t size, std::align_val_t alignment, const std::nothrow_t&) noexcept {
    return allocate_aligned(size, alignment);
}
void operator delete(void* memory) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
    std::free(memory);
}

namespace nearpose::test {

MemoryFault::MemoryFault(long failing, Shortage shortage) {
    count = 0;
    fails_at = failing;
    goes_on_failing = shortage == Shortage::kFromOn;
    counts = true;
}

MemoryFault::~MemoryFault() {
    counts = false;
}

long MemoryFault::allocations() const {
    return count;
}

}  // namespace nearpose::test
