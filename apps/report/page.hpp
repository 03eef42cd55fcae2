// The page: one HTML file with its script, style and data in it.
#pragma once

#include <string>

namespace nearpose::report {

// False where the program was built without the viewer.
bool viewer_available();

// `json` is what the script shows. Throws std::runtime_error, saying what to install, where there is no viewer.
std::string page(const std::string& title, const std::string& json);

}  // namespace nearpose::report
