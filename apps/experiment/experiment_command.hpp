// nearpose experiment: a grid of simulated runs, its tables and curves.
#pragma once

#include "apps/base/command.hpp"

namespace nearpose::program {

void add_experiment_command(CLI::App& app, const SharedOptions& shared, Run& run);

}  // namespace nearpose::program
