// A set-up's errors as a file: what `nearpose calibrate --out` writes and `nearpose estimate --set-up` takes.
#pragma once

#include <filesystem>

#include "apps/set_up/calibration.hpp"

namespace nearpose::program {

// JSON with "format": "nearpose set-up". Lengths in mm, angles in degrees, times in ms, shares in %; with standard
// deviations. Throws std::runtime_error where the file cannot be written.
void write_setup_file(const std::filesystem::path& path, const Calibration& calibration);

// The errors alone. Throws std::runtime_error naming file and key.
SetupErrors read_setup_file(const std::filesystem::path& path);

}  // namespace nearpose::program
