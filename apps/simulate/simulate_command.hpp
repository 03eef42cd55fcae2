// nearpose simulate: a BOP data set of simulated depth images.
#pragma once

#include "apps/base/command.hpp"

namespace nearpose::program {

void add_simulate_command(CLI::App& app, const SharedOptions& shared, Run& run);

}  // namespace nearpose::program
