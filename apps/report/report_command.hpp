// `nearpose report`: one HTML file about a run or an experiment.
#pragma once

#include "apps/base/command.hpp"

namespace nearpose::program {

void add_report_command(CLI::App& app, const SharedOptions& shared, Run& run);

}  // namespace nearpose::program
