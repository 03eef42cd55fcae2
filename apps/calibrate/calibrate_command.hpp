// nearpose calibrate: what a recording says of its set-up.
#pragma once

#include "apps/base/command.hpp"

namespace nearpose::program {

void add_calibrate_command(CLI::App& app, const SharedOptions& shared, Run& run);

}  // namespace nearpose::program
