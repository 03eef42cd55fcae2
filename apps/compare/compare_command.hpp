#pragma once

#include "apps/base/command.hpp"

namespace nearpose::program {

// nearpose compare: ray casting, the rasteriser and stored views side by side.
void add_compare_command(CLI::App& app, const SharedOptions& shared, Run& run);

}  // namespace nearpose::program
