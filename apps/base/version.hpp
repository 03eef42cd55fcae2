// What this build is made of.
#pragma once

#include <string>

namespace nearpose::program {

// "0.1.0".
std::string version_number();

// Several lines: version, source revision, compiler, versions of the libraries that decide about results.
std::string version_text();

}  // namespace nearpose::program
