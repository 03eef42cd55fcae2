#include "apps/base/console.hpp"

#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "apps/base/file_io.hpp"
#include "apps/base/number_text.hpp"

namespace nearpose::program {
namespace {

volatile sig_atomic_t stop_requested = 0;
bool bar_on_line = false;  // a bar stands on the terminal's current line

void request_stop(int) {
    stop_requested = 1;
}

// To the error stream in one call, so that lines of several programs do not mix. There is nobody left to tell where
// this fails.
void say(std::string text) {
    if (bar_on_line) text.insert(0, "\r\033[K");
    bar_on_line = false;
    std::string_view rest = text;
    while (!rest.empty()) {
        const ssize_t written = write(STDERR_FILENO, rest.data(), rest.size());
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) return;
        rest.remove_prefix(static_cast<std::size_t>(written));
    }
}

std::string one_line(std::string_view message) {
    std::string line(message);
    std::replace_if(
        line.begin(), line.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
    while (!line.empty() && line.back() == ' ') line.pop_back();
    return line + "\n";
}

}  // namespace

void print_error(std::string_view message) {
    say("nearpose: error: " + one_line(message));
}

void print_notice(std::string_view message, bool quiet) {
    if (!quiet) say("nearpose: notice: " + one_line(message));
}

void print(std::string_view text) {
    while (!text.empty()) {
        const ssize_t written = write(STDOUT_FILENO, text.data(), text.size());
        if (written < 0 && errno == EINTR) continue;
        if (written < 0 && errno == EPIPE) throw data_set::ClosedPipe("standard output: its reader has gone");
        if (written <= 0) throw std::runtime_error(std::string("standard output: cannot write: ") + strerror(errno));
        text.remove_prefix(static_cast<std::size_t>(written));
    }
}

bool interrupted() {
    return stop_requested != 0;
}

void catch_interrupts() {
    struct sigaction action = {};
    action.sa_handler = request_stop;
    action.sa_flags = static_cast<int>(SA_RESTART | SA_RESETHAND);  // a second Ctrl-C ends the program at once
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
        struct sigaction before = {};
        sigaction(signal, nullptr, &before);
        if (before.sa_handler != SIG_IGN) sigaction(signal, &action, nullptr);  // nohup has it ignored
    }
}

void let_writes_fail() {
    struct sigaction ignore = {};
    ignore.sa_handler = SIG_IGN;
    sigaction(SIGPIPE, &ignore, nullptr);
    sigaction(SIGXFSZ, &ignore, nullptr);
}

Progress::Progress(std::string_view label, int total, bool quiet)
    : label_(label),
      total_(std::max(total, 1)),
      shown_(!quiet && isatty(STDERR_FILENO) == 1),
      begin_(std::chrono::steady_clock::now()) {
    if (shown_) draw();
}

Progress::~Progress() {
    if (shown_ && bar_on_line) say("");
}

void Progress::step() {
    ++done_;
    if (shown_) draw();
}

void Progress::draw() {
    constexpr int kWidth = 40;
    const int full = static_cast<int>(static_cast<long>(kWidth) * std::min(done_, total_) / total_);
    std::string line = label_ + " [" + std::string(full, '#') + std::string(kWidth - full, '.') + "] " +
                       std::to_string(done_) + "/" + std::to_string(total_);
    const double elapsed_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
    if (done_ > 0 && done_ < total_) {
        line += ", " + data_set::format_fixed(elapsed_s / done_ * (total_ - done_), 0) + " s left";
    }
    say("\r" + line + "\033[K");
    bar_on_line = true;
}

}  // namespace nearpose::program
