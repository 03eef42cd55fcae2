// The options of `nearpose estimate`: how the command line names them, and which go together.
#pragma once

#include "apps/base/command.hpp"
#include "apps/runs/run_options.hpp"

namespace nearpose::program {

void add_estimate_options(CLI::App& command, EstimateOptions& options);

// Throws BadUse where they do not fit together.
void check(const EstimateOptions& options);

}  // namespace nearpose::program
