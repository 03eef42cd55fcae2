#include "core/base/parallel.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <stdexcept>
#include <string>
#include <vector>

namespace nearpose {
namespace {

TEST(Parallel, EveryIndexOnce) {
    for (const int threads : {0, 1, 2, 3, 7}) {
        std::vector<std::atomic<int>> calls(1000);
        parallel_for(1000, threads, [&](int i) { ++calls[i]; });
        for (const auto& count : calls) EXPECT_EQ(count, 1);
    }
    parallel_for(0, 2, [](int) { FAIL(); });
}

TEST(Parallel, TheExceptionOfTheLowestIndexArrives) {
    for (const int threads : {1, 3}) {
        std::atomic<int> calls = 0;
        try {
            parallel_for(100, threads, [&](int i) {
                ++calls;
                if (i == 7 || i == 50 || i == 99) throw std::runtime_error(std::to_string(i));
            });
            FAIL();
        } catch (const std::runtime_error& error) {
            EXPECT_STREQ(error.what(), "7");
        }
        EXPECT_EQ(calls, 100) << "the other calls are still made";
    }
}

TEST(Parallel, AForkedChildRunsSerially) {
    std::atomic<int> before = 0;
    parallel_for(10, 2, [&](int) { ++before; });
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
        alarm(20);    // a hang ends with a signal, not with this status
        int sum = 0;  // not atomic: the loop is serial here
        parallel_for(10, 2, [&](int i) { sum += i; });
        _exit(sum == 45 ? 0 : 1);
    }
    int status = -1;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
}

}  // namespace
}  // namespace nearpose
