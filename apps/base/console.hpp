// What a command says to its user. Standard output is for results alone; everything here but print goes to the standard
// error stream.
#pragma once

#include <chrono>
#include <string>
#include <string_view>

namespace nearpose::program {

// "nearpose: error: <message>" in one line.
void print_error(std::string_view message);
// "nearpose: notice: <message>" in one line; nothing where `quiet`.
void print_notice(std::string_view message, bool quiet);

// Writes to the standard output; throws data_set::ClosedPipe where its reader has gone, std::runtime_error on a full
// disk.
void print(std::string_view text);

// True after Ctrl-C (SIGINT), SIGTERM, or SIGHUP where it is not ignored. A command asks once a frame, finishes what it
// is writing, and returns kInterrupted. Without catch_interrupts() the signals end the program at once.
bool interrupted();
void catch_interrupts();
// Writing to a closed pipe, or beyond the limit on a file's size, fails instead of ending the program.
void let_writes_fail();

// A bar with the time left; drawn only where the standard error stream is a terminal and `quiet` is not set. Messages
// may be printed between two steps: the bar clears its line before them.
class Progress {
  public:
    Progress(std::string_view label, int total, bool quiet);
    ~Progress();  // ends the line
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    void step();  // one more of `total` is done

  private:
    void draw();

    std::string label_;
    int total_;
    int done_ = 0;
    bool shown_;
    std::chrono::steady_clock::time_point begin_;
};

}  // namespace nearpose::program
