// The commands that write files, on inputs of a fraction of a second, and what they may leave behind.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "tests/apps/support/tiny_scene.hpp"

namespace nearpose::program_tests {

struct CommandCase {
    std::string name;
    std::string arguments;      // but for the place of the output
    std::string output;         // its option
    std::filesystem::path out;  // the folder of all that is written
    bool asks;                  // between frames whether it is to stop, and then cleans up
};

// On the inputs below `scene`, which are made here.
std::vector<CommandCase> command_cases(const TinyScene& scene);

// The shell's words that run it; those before `$NEARPOSE` are `before`.
std::string line_of(const CommandCase& command, const std::string& before);

// All files below a folder with their contents but times, by path; empty where the folder is not there.
using Files = std::map<std::string, std::string>;
Files files_below(const std::filesystem::path& folder);

// Whether a file's name says that it is a temporary one.
bool is_temporary(const std::string& path);

// Fails the test unless every file of `left` is whole: equal to that of `expected` or, of those that grow, some whole
// rows from its beginning on. `temporaries`: files whose names say that they are temporary may be there.
void expect_whole(const Files& left, const Files& expected, bool temporaries, const std::string& what);

}  // namespace nearpose::program_tests
