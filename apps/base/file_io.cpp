#include "apps/base/file_io.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <utility>

namespace nearpose::data_set {
namespace {

std::runtime_error system_error(const std::string& name, const std::string& what, int code) {
    return std::runtime_error(name + ": " + what + ": " + std::generic_category().message(code));
}

// What a user can do about a file that cannot be written; begins with "; ".
std::string remedy(int code) {
    switch (code) {
        case ENOSPC:
        case EDQUOT:
            return "; make room, or name another place";
        case EFBIG:
            return "; raise the limit on the size of files (ulimit -f)";
        case EMFILE:
        case ENFILE:
            return "; raise the limit on open files (ulimit -n)";
        case EACCES:
        case EPERM:
        case EROFS:
            return "; name a place that you may write to";
        case EIO:
            return "; the disk may be failing: name another place";
        default:
            return "";
    }
}

std::runtime_error write_error(const std::string& name, const std::string& what, int code) {
    return std::runtime_error(system_error(name, what, code).what() + remedy(code));
}

// Number of bytes handed to the system before an error; all of them where there was none. errno tells the error.
std::size_t write_all(int descriptor, std::string_view bytes) {
    std::size_t done = 0;
    while (done < bytes.size()) {
        const ssize_t count = ::write(descriptor, bytes.data() + done, bytes.size() - done);
        if (count > 0) done += static_cast<std::size_t>(count);
        if (count == 0) errno = ENOSPC;
        if (count == 0 || (count < 0 && errno != EINTR)) break;
    }
    return done;
}

// Owns a descriptor on the ways out that throw.
class Descriptor {
  public:
    explicit Descriptor(int value) : value_(value) {}
    ~Descriptor() {
        if (value_ >= 0) ::close(value_);
    }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    Descriptor(Descriptor&& other) noexcept : value_(std::exchange(other.value_, -1)) {}
    int get() const { return value_; }
    // Network file systems report a full disk only here.
    bool close() { return ::close(std::exchange(value_, -1)) == 0; }

  private:
    int value_;
};

void write_and_close(Descriptor& file, std::string_view bytes, const std::string& name) {
    if (file.get() < 0) throw write_error(name, "cannot be opened for writing", errno);
    if (write_all(file.get(), bytes) != bytes.size()) throw write_error(name, "cannot be written", errno);
    if (!file.close()) throw write_error(name, "cannot be closed", errno);
}

// Opens for reading; throws where it is anything but a regular file.
Descriptor open_regular(const std::filesystem::path& path, std::uintmax_t& size) {
    const std::string name = path.string();
    // Not blocking: opening a pipe that nobody writes to would wait for ever.
    Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    if (file.get() < 0) throw system_error(name, "cannot be opened", errno);
    struct stat status {};
    if (::fstat(file.get(), &status) != 0) throw system_error(name, "cannot be examined", errno);
    if (!S_ISREG(status.st_mode)) throw std::runtime_error(name + ": is not a regular file");
    size = static_cast<std::uintmax_t>(status.st_size);
    return file;
}

std::string read_bytes(const Descriptor& file, std::uintmax_t size, const std::string& name) {
    std::string bytes(size, '\0');
    std::size_t done = 0;
    while (done < bytes.size()) {
        const ssize_t count = ::read(file.get(), bytes.data() + done, bytes.size() - done);
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) throw system_error(name, "cannot be read", errno);
        if (count == 0) throw std::runtime_error(name + ": became shorter while it was read");
        done += static_cast<std::size_t>(count);
    }
    return bytes;
}

}  // namespace

std::string read_whole_file(const std::filesystem::path& path, std::uintmax_t max_bytes) {
    std::uintmax_t size = 0;
    const Descriptor file = open_regular(path, size);
    if (size > max_bytes) {
        throw std::runtime_error(path.string() + ": has " + std::to_string(size) + " bytes, more than the limit of " +
                                 std::to_string(max_bytes));
    }
    return read_bytes(file, size, path.string());
}

std::string read_file_start(const std::filesystem::path& path, std::uintmax_t count) {
    std::uintmax_t size = 0;
    const Descriptor file = open_regular(path, size);
    return read_bytes(file, std::min(size, count), path.string());
}

void write_file_atomically(const std::filesystem::path& path, std::string_view bytes) {
    const std::string name = path.string();
    std::error_code ignored;
    const auto kind = std::filesystem::status(path, ignored).type();
    if (kind == std::filesystem::file_type::directory) throw std::runtime_error(name + ": is a folder");
    if (kind != std::filesystem::file_type::regular && kind != std::filesystem::file_type::not_found) {
        // A device or pipe: a rename would put a plain file in its place.
        Descriptor device(::open(path.c_str(), O_WRONLY | O_CLOEXEC));
        return write_and_close(device, bytes, name);
    }
    const std::filesystem::path target =
        std::filesystem::is_symlink(path, ignored) ? std::filesystem::weakly_canonical(path) : path;
    std::filesystem::path temporary = target;
    temporary += ".part" + std::to_string(::getpid());
    Descriptor file(::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666));
    try {
        write_and_close(file, bytes, name);
        if (::rename(temporary.c_str(), target.c_str()) != 0) throw write_error(name, "cannot be replaced", errno);
    } catch (...) {
        ::unlink(temporary.c_str());
        throw;
    }
}

void create_folder(const std::filesystem::path& folder) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error)
        throw std::runtime_error(folder.string() + ": the folder cannot be created: " + error.message() +
                                 remedy(error.value()));
    // create_directories is content where a file stands in the way under some library versions.
    if (!std::filesystem::is_directory(folder, error)) throw std::runtime_error(folder.string() + ": is not a folder");
}

const std::filesystem::path& with_folder(const std::filesystem::path& file) {
    if (file.has_parent_path()) create_folder(file.parent_path());  // "-" has none
    return file;
}

RowFile::RowFile(const std::filesystem::path& path) : name_(path == "-" ? "standard output" : path.string()) {
    if (path == "-") {
        descriptor_ = STDOUT_FILENO;
        return;
    }
    descriptor_ = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_APPEND, 0666);
    if (descriptor_ < 0) throw write_error(name_, "cannot be opened for writing", errno);
    owned_ = true;
}

RowFile::~RowFile() {
    if (owned_) ::close(descriptor_);
}

void RowFile::append(std::string_view rows) {
    const std::size_t done = write_all(descriptor_, rows);
    if (done == rows.size()) return;
    const int code = errno;
    // Half a row would spoil the file for its readers. Only a regular file can be shortened; a pipe just says no.
    struct stat status {};
    if (owned_ && done > 0 && ::fstat(descriptor_, &status) == 0 && S_ISREG(status.st_mode)) {
        if (::ftruncate(descriptor_, status.st_size - static_cast<off_t>(done)) != 0) {
            throw write_error(name_, "cannot be written, and its last row is cut", code);
        }
    }
    if (code == EPIPE) throw ClosedPipe(name_ + ": nobody reads it any more");
    throw write_error(name_, "cannot be written", code);
}

void RowFile::close() {
    if (!owned_) return;
    owned_ = false;
    const int descriptor = descriptor_;
    descriptor_ = -1;
    if (::close(descriptor) != 0) throw write_error(name_, "cannot be closed", errno);
}

}  // namespace nearpose::data_set
