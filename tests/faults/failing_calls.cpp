// A library to be preloaded (LD_PRELOAD): the n-th of the calls by which a program changes files fails, or the program
// is killed there. What to do comes from the environment:
//   NEARPOSE_FAULT_AT     n, from 1 on; calls of all threads are counted
//   NEARPOSE_FAULT_KIND   fail (EIO), full (ENOSPC), half (a write takes half of its bytes, and the next one fails),
//                         short (a write takes half of its bytes, which is no error), kill (SIGKILL instead of the
//                         call)
//   NEARPOSE_FAULT_MARK   a file that is made when the fault has happened
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <cstdlib>
#include <cstring>

namespace {

enum class Fault { kNone, kError, kHalf };

std::atomic<long> calls = 0;
std::atomic<bool> next_write_fails = false;

const char* setting(const char* name) {
    const char* text = std::getenv(name);
    return text == nullptr ? "" : text;
}

void mark() {
    const long file = syscall(SYS_openat, AT_FDCWD, setting("NEARPOSE_FAULT_MARK"), O_WRONLY | O_CREAT, 0644);
    if (file >= 0) syscall(SYS_close, file);
}

Fault error() {
    errno = std::strcmp(setting("NEARPOSE_FAULT_KIND"), "full") == 0 ? ENOSPC : EIO;
    return Fault::kError;
}

// What is to become of the present call.
Fault fault(bool is_write) {
    if (is_write && next_write_fails.exchange(false)) return error();
    if (++calls != std::atol(setting("NEARPOSE_FAULT_AT"))) return Fault::kNone;
    mark();
    const char* kind = setting("NEARPOSE_FAULT_KIND");
    if (std::strcmp(kind, "kill") == 0) kill(getpid(), SIGKILL);
    const bool half = std::strcmp(kind, "half") == 0, cut = std::strcmp(kind, "short") == 0;
    if (!half && !cut) return error();
    if (!is_write) return half ? error() : Fault::kNone;
    if (half) next_write_fails = true;
    return Fault::kHalf;
}

template <typename Function>
Function next(const char* name) {
    return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

bool is_file(int descriptor) {
    return descriptor > STDERR_FILENO;
}

}  // namespace

extern "C" {

ssize_t write(int descriptor, const void* bytes, size_t count) {
    const Fault what = is_file(descriptor) ? fault(true) : Fault::kNone;
    if (what == Fault::kError) return -1;
    return syscall(SYS_write, descriptor, bytes, what == Fault::kHalf && count > 1 ? count / 2 : count);
}

ssize_t writev(int descriptor, const iovec* parts, int count) {
    const Fault what = is_file(descriptor) ? fault(true) : Fault::kNone;
    if (what == Fault::kError) return -1;
    if (what == Fault::kHalf) return syscall(SYS_write, descriptor, parts[0].iov_base, parts[0].iov_len / 2);
    return syscall(SYS_writev, descriptor, parts, count);
}

int rename(const char* from, const char* to) noexcept {
    static const auto real = next<int (*)(const char*, const char*)>("rename");
    return fault(false) == Fault::kError ? -1 : real(from, to);
}

int mkdir(const char* path, mode_t mode) noexcept {
    static const auto real = next<int (*)(const char*, mode_t)>("mkdir");
    return fault(false) == Fault::kError ? -1 : real(path, mode);
}

int fsync(int descriptor) {
    static const auto real = next<int (*)(int)>("fsync");
    return fault(false) == Fault::kError ? -1 : real(descriptor);
}

// Of a file that was written, which network file systems may refuse as late as here.
int close(int descriptor) {
    const bool written = is_file(descriptor) && (fcntl(descriptor, F_GETFL) & O_ACCMODE) == O_WRONLY;
    const Fault what = written ? fault(false) : Fault::kNone;
    const int cause = errno;
    const int closed = static_cast<int>(syscall(SYS_close, descriptor));
    if (what != Fault::kError) return closed;
    errno = cause;
    return -1;
}

int open(const char* path, int flags, ...) {
    va_list more;
    va_start(more, flags);
    const mode_t mode = (flags & O_CREAT) != 0 ? va_arg(more, mode_t) : 0;
    va_end(more);
    if ((flags & O_ACCMODE) != O_RDONLY && fault(false) == Fault::kError) return -1;
    return static_cast<int>(syscall(SYS_openat, AT_FDCWD, path, flags, mode));
}

}  // extern "C"
