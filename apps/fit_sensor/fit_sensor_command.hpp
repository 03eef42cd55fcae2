// nearpose fit-sensor: a sensor file from frames of a flat wall.
#pragma once

#include "apps/base/command.hpp"

namespace nearpose::program {

void add_fit_sensor_command(CLI::App& app, const SharedOptions& shared, Run& run);

}  // namespace nearpose::program
