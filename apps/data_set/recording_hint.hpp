// What to do with a recording that is read by other programs alone.
#pragma once

#include <filesystem>
#include <string>

namespace nearpose::data_set {

// For a file or folder that is given as a scene and is none: what it is by its name or first bytes, and which tool
// makes depth images or clouds of it. Empty where that is not known.
std::string recording_hint(const std::filesystem::path& path);

}  // namespace nearpose::data_set
