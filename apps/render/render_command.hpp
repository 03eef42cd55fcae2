// nearpose render: the depth image of a model at a pose.
#pragma once

#include "apps/base/command.hpp"

namespace nearpose::program {

void add_render_command(CLI::App& app, const SharedOptions& shared, Run& run);

}  // namespace nearpose::program
