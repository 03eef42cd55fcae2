// A log of one JSON object a line.
#pragma once

#include <filesystem>
#include <string_view>

#include "apps/base/file_io.hpp"

namespace nearpose::data_set {

class JsonLinesWriter {
  public:
    explicit JsonLinesWriter(const std::filesystem::path& path) : file_(path) {}  // "-" is the standard output
    // `object` is a serialised object without line breaks; it is handed to the system as one whole row. Throws
    // std::invalid_argument where it is none, std::runtime_error where the row could not be written.
    void append(std::string_view object);
    void close() { file_.close(); }

  private:
    RowFile file_;
};

}  // namespace nearpose::data_set
