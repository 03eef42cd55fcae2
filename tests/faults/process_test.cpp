// Disk and process fail at any moment: whole files or none, an exit code, a message that names the file, and a rerun
// that gives the same bytes.
//
// In short one call in eleven fails and every command is killed at some of them; with NEARPOSE_LONG_TESTS every call in
// all ways, and a hundred kills by the clock.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>

#include "tests/apps/support/contains.hpp"
#include "tests/faults/command_cases.hpp"

namespace nearpose::program_tests {
namespace {

namespace fs = std::filesystem;

bool long_tests() {
    return std::getenv("NEARPOSE_LONG_TESTS") != nullptr;
}

class ProcessFault : public testing::TestWithParam<int> {
  protected:
    ProcessFault() : scene_(2), command_(command_cases(scene_).at(static_cast<std::size_t>(GetParam()))) {
        clear();
        const Outcome outcome = run_shell(line_of(command_, ""));
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
        expected_ = all_files();
        EXPECT_GT(expected_.size(), 1U);
    }

    fs::path outputs() const { return scene_.file("outputs"); }
    Files all_files() const { return files_below(outputs()); }
    void clear() const {
        fs::remove_all(outputs());
        fs::create_directories(outputs());
    }

    Files final_files() const {
        Files files = all_files();
        std::erase_if(files, [](const auto& file) { return is_temporary(file.first); });
        return files;
    }

    // The same command once more, on what the last one left; temporary files of that one may still be there. One that
    // was done need not be run again: data sets are not overwritten unless asked for.
    void expect_same_after_rerun(const std::string& what) const {
        if (final_files() == expected_) return;
        const Outcome again = run_shell(line_of(command_, ""));
        EXPECT_EQ(again.exit_code, 0) << what << ": " << again.err;
        Files files = final_files();
        for (const auto& [path, text] : expected_) EXPECT_EQ(files[path], text) << what << ": " << path;
        EXPECT_EQ(files.size(), expected_.size()) << what;
    }

    // It has told of a failure, and no file is cut.
    void expect_failure(const Outcome& outcome, const std::string& cause, const std::string& what) const {
        EXPECT_EQ(outcome.exit_code, 1) << what << ": " << outcome.err;
        EXPECT_TRUE(contains(outcome.err, cause)) << what << ": " << outcome.err;
        EXPECT_TRUE(contains(outcome.err, outputs().string())) << what << " names no file: " << outcome.err;
        EXPECT_EQ(lines_of(outcome.err).size(), 1U) << what << ": " << outcome.err;
        expect_whole(all_files(), expected_, false, what);
    }

    // With the n-th call failing in a way; false where there are not so many calls.
    bool run_with_fault(int n, const std::string& kind, Outcome& outcome) const {
        const fs::path mark = scene_.file("mark");
        fs::remove(mark);
        outcome = run_shell(
            line_of(command_, "NEARPOSE_FAULT_AT=" + std::to_string(n) + " NEARPOSE_FAULT_KIND=" + kind +
                                  " NEARPOSE_FAULT_MARK=" + mark.string() + " LD_PRELOAD=" NEARPOSE_FAILING_CALLS));
        return fs::exists(mark);
    }

    TinyScene scene_;
    CommandCase command_;
    Files expected_;
};

TEST_P(ProcessFault, ACallThatFailsLeavesWholeFiles) {
    struct Way {
        const char *kind, *cause;
    };
    int faults = 0;
    const int step = long_tests() ? 1 : 11;
    for (const Way& way :
         {Way{"fail", "Input/output error"}, Way{"full", "No space left"}, Way{"half", "Input/output"}}) {
        for (int n = 1 + faults % step; n < 1000; n += step) {
            clear();
            Outcome outcome;
            if (!run_with_fault(n, way.kind, outcome)) break;
            ++faults;
            const std::string what = command_.name + ", " + way.kind + " at call " + std::to_string(n);
            expect_failure(outcome, way.cause, what);
            if (long_tests() || faults % 3 == 0) expect_same_after_rerun(what);
        }
    }
    EXPECT_GT(faults, 1);
    RecordProperty("faults", faults);
}

TEST_P(ProcessFault, AShortWriteIsNoFailure) {
    int writes = 0;
    for (int n = 2; n < 1000; n += long_tests() ? 1 : 19) {
        clear();
        Outcome outcome;
        if (!run_with_fault(n, "short", outcome)) break;
        ++writes;
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
        EXPECT_EQ(all_files(), expected_) << command_.name << ", call " << n;
    }
    EXPECT_GT(writes, 0);
}

TEST_P(ProcessFault, AKillBeforeAnyCallLeavesWholeFiles) {
    int kills = 0;
    for (int n = 1; n < 1000; n += long_tests() ? 1 : 13) {
        clear();
        Outcome outcome;
        if (!run_with_fault(n, "kill", outcome)) break;
        ++kills;
        const std::string what = command_.name + ", killed at call " + std::to_string(n);
        EXPECT_EQ(outcome.exit_code, 137) << what;
        expect_whole(all_files(), expected_, true, what);
        if (long_tests() || kills % 4 == 0) expect_same_after_rerun(what);
    }
    EXPECT_GT(kills, 0);
}

TEST_P(ProcessFault, ASignalAtAnyMomentLeavesWholeFiles) {
    const auto begin = std::chrono::steady_clock::now();
    clear();
    run_shell(line_of(command_, ""));
    const double usual_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    const int moments = long_tests() ? 100 : 2;
    for (const char* signal : {"KILL", "TERM", "HUP", "PIPE"}) {
        const bool kills = std::string(signal) == "KILL";
        for (int k = 0; k < (kills ? moments : (moments + 9) / 10); ++k) {
            clear();
            const double moment_s = usual_s * (k + 0.5) / (kills ? moments : (moments + 9) / 10);
            const Outcome outcome = run_shell(line_of(command_, "") + " & pid=$!; sleep " + std::to_string(moment_s) +
                                              "; kill -" + signal + " $pid 2>/dev/null; wait $pid");
            const std::string what = command_.name + ", SIG" + signal + " after " + std::to_string(moment_s) + " s";
            const bool stopped = outcome.exit_code != 0;  // it may have been done
            if (std::string(signal) == "PIPE") {          // it is ignored, but not yet while the program is loaded
                EXPECT_TRUE(!stopped || all_files().empty()) << what << ": " << outcome.err;
            }
            expect_whole(all_files(), expected_, stopped && (kills || !command_.asks), what);
            if (!stopped) {
                EXPECT_EQ(all_files(), expected_) << what;
            }
            expect_same_after_rerun(what);
        }
    }
}

// Of what the shell limits: size of files [KiB], memory [KiB], open files.
TEST_P(ProcessFault, ALimitOfTheProcessLeavesWholeFiles) {
    for (const char* limit : {"-f 1", "-v 150000", "-v 250000", "-v 400000", "-n 16"}) {
        clear();
        const Outcome outcome = run_shell("ulimit " + std::string(limit) + "; " + line_of(command_, "exec"));
        const std::string what = command_.name + " under ulimit " + limit;
        if (outcome.exit_code == 0) {
            EXPECT_EQ(all_files(), expected_) << what;
            continue;
        }
        EXPECT_FALSE(outcome.err.empty()) << what;
        if (std::string(limit) == "-f 1") expect_failure(outcome, "File too large", what);
        // Where a thread cannot be started, OpenMP's library ends the program, and nobody cleans up.
        expect_whole(all_files(), expected_, std::string(limit).starts_with("-v"), what);
        expect_same_after_rerun(what);
    }
}

TEST_P(ProcessFault, AFolderThatCannotBeWrittenIsNamed) {
    CommandCase command = command_;
    command.out = "/proc/self/nowhere/test/000001";
    const Outcome outcome = run_shell(line_of(command, ""));
    EXPECT_EQ(outcome.exit_code, 1) << command_.name << ": " << outcome.err;
    EXPECT_TRUE(contains(outcome.err, "/proc/self/nowhere")) << outcome.err;
    EXPECT_EQ(lines_of(outcome.err).size(), 1U) << outcome.err;
}

std::string name_of(const testing::TestParamInfo<int>& number) {
    constexpr const char* kNames[] = {"estimate", "experiment", "simulate", "import_recording", "import_model"};
    return kNames[number.param];
}

INSTANTIATE_TEST_SUITE_P(OfACommand, ProcessFault, testing::Range(0, 5), name_of);

}  // namespace
}  // namespace nearpose::program_tests
