// Whole files in, whole files out, and files that grow by whole rows. Every error names the file and its cause.
#pragma once

#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>

namespace nearpose::data_set {

// Thrown when the reader of our standard output has gone away (`nearpose ... --out - | head`): no fault of the run. It
// is only seen where the program ignores SIGPIPE.
class ClosedPipe : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

// The bytes of a regular file. Throws std::runtime_error where it is missing, no regular file (a pipe would block for
// ever), unreadable, or longer than `max_bytes`; nothing is allocated before the size is known.
std::string read_whole_file(const std::filesystem::path& path, std::uintmax_t max_bytes);
// Its first `count` bytes, or all where it is shorter.
std::string read_file_start(const std::filesystem::path& path, std::uintmax_t count);

// Writes to a temporary name in the same folder and renames, so that a reader sees the old file or the whole new one. A
// link is followed; a device or pipe is written in place. Throws std::runtime_error where any step fails, also on a
// full disk, and leaves no temporary file behind.
void write_file_atomically(const std::filesystem::path& path, std::string_view bytes);

// Creates the folder and its parents; throws std::runtime_error that names it.
void create_folder(const std::filesystem::path& folder);
// Returns the path of a file to be written; its folder exists afterwards.
const std::filesystem::path& with_folder(const std::filesystem::path& file);

// A file that is begun anew and grows by whole rows, each handed to the system by itself as soon as it is appended, so
// that a run that is cut short leaves whole rows. "-" is the standard output.
class RowFile {
  public:
    explicit RowFile(const std::filesystem::path& path);
    ~RowFile();
    RowFile(const RowFile&) = delete;
    RowFile& operator=(const RowFile&) = delete;

    // `rows` holds one or more whole rows with their line ends. Throws std::runtime_error on a full disk; what was
    // written of the rows by then is taken back. Throws ClosedPipe where nobody reads any more.
    void append(std::string_view rows);

    // Closes the file and throws where the system only now reports a failed write. Later calls of append are bugs.
    void close();

    const std::string& name() const { return name_; }  // for messages

  private:
    std::string name_;
    int descriptor_ = -1;
    bool owned_ = false;  // false for the standard output, which is not ours to close
};

}  // namespace nearpose::data_set
