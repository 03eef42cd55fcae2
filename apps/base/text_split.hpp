// Cutting text files into lines and fields.
#pragma once

#include <string_view>
#include <vector>

namespace nearpose::data_set {

// The parts between separators; empty parts count: "a,,b" has three.
std::vector<std::string_view> split(std::string_view text, char separator);

// The parts between runs of spaces and tabs; none is empty.
std::vector<std::string_view> words(std::string_view text);

// The lines of a file without their ends (LF or CR LF). A final line end ends the last line and begins no other.
std::vector<std::string_view> lines(std::string_view text);

}  // namespace nearpose::data_set
