// nearpose import: recordings and models of other tools into the layout of a scene.
#pragma once

#include "apps/base/command.hpp"

namespace nearpose::program {

void add_import_command(CLI::App& app, const SharedOptions& shared, Run& run);

}  // namespace nearpose::program
