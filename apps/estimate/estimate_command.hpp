// nearpose estimate: the pose of a part in every frame of a scene.
#pragma once

#include "apps/base/command.hpp"

namespace nearpose::program {

void add_estimate_command(CLI::App& app, const SharedOptions& shared, Run& run);

}  // namespace nearpose::program
