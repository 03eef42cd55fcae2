// Memory that runs out when a test says so: a program that is linked with it allocates through it.
#pragma once

namespace nearpose::test {

enum class Shortage {
    kOnce,    // one allocation fails, those after it do not
    kFromOn,  // it fails and so do all after it
};

// While one of these lives, allocations of all threads are counted from 1, and the `failing`-th fails; 0: none does.
// `new` then throws std::bad_alloc and std::malloc gives nothing, as Eigen's arrays see it. Not for two at once.
class MemoryFault {
  public:
    explicit MemoryFault(long failing, Shortage shortage = Shortage::kOnce);
    ~MemoryFault();
    MemoryFault(const MemoryFault&) = delete;
    MemoryFault& operator=(const MemoryFault&) = delete;

    long allocations() const;  // so far
};

}  // namespace nearpose::test
