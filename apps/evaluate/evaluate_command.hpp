// nearpose evaluate: errors of a result file against the true poses of its scene.
#pragma once

#include "apps/base/command.hpp"

namespace nearpose::program {

void add_evaluate_command(CLI::App& app, const SharedOptions& shared, Run& run);

}  // namespace nearpose::program
